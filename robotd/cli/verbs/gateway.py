"""``gateway token``: who may sign in to the console. They need no daemon, and no gateway."""

import argparse
import time
from pathlib import Path

from robotd.cli.exit_codes import OK
from robotd.cli.quantities import positive
from robotd.cli.show.terminal import complain, out, print_json, print_table
from robotd.cli.verb import Verb
from robotd.gateway.access.roles import Role
from robotd.gateway.access.tokens import Token, TokenError, TokenFile, make_token
from robotd.gateway.settings import DEFAULT_FILE, GatewaySettings
from robotd.toml.settings_reader import read_file

_DAY_S = 86_400.0
_LONGEST_NAME = 40


def _settings(arguments: argparse.Namespace) -> GatewaySettings:
    if arguments.config is None and not Path(DEFAULT_FILE).exists():
        return GatewaySettings()
    return read_file(GatewaySettings, arguments.config or Path(DEFAULT_FILE))


def _new(arguments: argparse.Namespace) -> int:
    settings = _settings(arguments)
    if not (arguments.name.isprintable() and 1 <= len(arguments.name) <= _LONGEST_NAME):
        raise TokenError(f"a name has 1 to {_LONGEST_NAME} letters, got {arguments.name!r}")
    file = TokenFile(settings.access.tokens)
    lives_s = None if arguments.days is None else arguments.days * _DAY_S
    secret, token = make_token(
        arguments.name, Role(arguments.role), time.time(), lives_s, is_for_one_use=arguments.once
    )
    file.write(file.read().with_new(token))
    address = f"{arguments.address or _address(settings)}#{secret}"
    if arguments.json:
        print_json({"name": token.name, "role": token.role, "token": secret, "address": address})
        return OK
    out().print(address, markup=False, soft_wrap=True)
    _print_code(address)
    complain(
        f"{token.name} signs in with it as {token.role}; it is shown once, and only its hash is kept in {file.path}"
    )
    return OK


def _address(settings: GatewaySettings) -> str:
    listen = settings.listen
    host = listen.allowed_hosts[0] if listen.allowed_hosts else "127.0.0.1" if listen.host == "0.0.0.0" else listen.host
    scheme = "https" if listen.has_tls or listen.trusted_proxies else "http"
    return f"{scheme}://{host}/" if listen.trusted_proxies else f"{scheme}://{host}:{listen.port}/"


def _print_code(address: str) -> None:
    """Print the address for a phone's camera, where the library for it is installed."""
    try:
        import segno  # noqa: PLC0415  # of the extra gateway; a token is one without a picture, too
    except ImportError:
        return
    segno.make(address, error="l").terminal(compact=True)


def _list(arguments: argparse.Namespace) -> int:
    tokens = TokenFile(_settings(arguments).access.tokens).read().all
    if arguments.json:
        print_json([{"name": one.name, "role": one.role, "expires_unix_s": one.expires_unix_s} for one in tokens])
        return OK
    print_table(("name", "role", "until"), [(one.name, one.role, _until(one)) for one in tokens])
    return OK


def _until(token: Token) -> str:
    if not token.sha256:
        return "used up"
    if token.expires_unix_s is None:
        return "it is revoked"
    over = "over since " if time.time() >= token.expires_unix_s else ""
    return over + time.strftime("%Y-%m-%d %H:%M", time.localtime(token.expires_unix_s))


def _revoke(arguments: argparse.Namespace) -> int:
    file = TokenFile(_settings(arguments).access.tokens)
    file.write(file.read().without(arguments.name))
    if arguments.json:
        print_json({"name": arguments.name})
    else:
        out().print(f"{arguments.name} signs in no more, and is signed out at once", markup=False)
    return OK


def _new_arguments(parser: argparse.ArgumentParser) -> None:
    parser.add_argument("name", metavar="NAME", help="who it is for, as others see them")
    parser.add_argument("--role", choices=[*Role], default=Role.VIEWER.value, help="what they may (default: viewer)")
    parser.add_argument("--days", type=positive, metavar="N", help="how long it stands (default: until it is revoked)")
    parser.add_argument("--once", action="store_true", help="it signs in once; that session goes on")
    parser.add_argument("--address", metavar="URL", help="where browsers find the console (default: by the settings)")
    _config_argument(parser)


def _revoke_arguments(parser: argparse.ArgumentParser) -> None:
    parser.add_argument("name", metavar="NAME", help="whose token")
    _config_argument(parser)


def _config_argument(parser: argparse.ArgumentParser) -> None:
    parser.add_argument("--config", type=Path, metavar="FILE", help=f"the gateway's settings (default: {DEFAULT_FILE})")


VERBS = (
    Verb(
        "gateway token new",
        "make a token that signs somebody in to the console, and print the address with it",
        "robotctl gateway token new anna --role operator",
        _new,
        _new_arguments,
    ),
    Verb("gateway token list", "list who may sign in", "robotctl gateway token list", _list, _config_argument),
    Verb(
        "gateway token revoke",
        "let somebody sign in no more, and sign them out",
        "robotctl gateway token revoke anna",
        _revoke,
        _revoke_arguments,
    ),
)
