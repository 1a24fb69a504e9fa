"""Tokens: secrets that sign somebody in, of which only the hashes are kept.

They live in one file that the command line writes and the gateway reads again when it changes. A token that is gone
from it is revoked, and so are the sessions that it began.
"""

import hmac
import os
import secrets
import tempfile
from dataclasses import dataclass
from hashlib import sha256
from pathlib import Path

import msgspec

from robotd.core.errors import ConfigError, RobotdError
from robotd.gateway.access.roles import Role

_BYTES = 32
_LONGEST_FILE = 1 << 20
SECRET_LENGTH = 43
"""Letters of a secret: 256 bits in base64, without the padding."""


class TokenError(RobotdError):
    """A token cannot be made or found; says why."""


class Token(msgspec.Struct, frozen=True, forbid_unknown_fields=True):
    """What is kept of a token: all but its secret."""

    name: str
    """Who it is for; the audit and the other browsers show it."""
    role: Role
    sha256: str
    """Of the secret, in hexadecimal; empty once a token for one use was used."""
    made_unix_s: int
    expires_unix_s: int | None = None
    is_for_one_use: bool = False

    def is_valid(self, now_unix_s: float) -> bool:
        """Return whether its time is not over."""
        return self.expires_unix_s is None or now_unix_s < self.expires_unix_s


def hashed(secret: str) -> str:
    """Return what is kept of a secret. It is random, so one round is enough: there is nothing to guess."""
    return sha256(secret.encode("utf-8", "surrogatepass")).hexdigest()


@dataclass(frozen=True, slots=True)
class Tokens:
    """All tokens that stand, by name each at most one."""

    all: tuple[Token, ...] = ()

    def match(self, secret: str, now_unix_s: float) -> Token | None:
        """Return the token of a secret; what it takes does not depend on which of them comes near."""
        wanted = hashed(secret)
        # All are compared, and each in constant time: how long it takes tells nothing of which came near.
        found = [token for token in self.all if hmac.compare_digest(token.sha256, wanted)]
        return next((token for token in found if token.is_valid(now_unix_s)), None)

    def named(self, name: str) -> Token | None:
        """Return the token made for somebody, whether its time is over or not; None if there is none."""
        return next((token for token in self.all if token.name == name), None)

    def usable(self, now_unix_s: float) -> bool:
        """Return whether anybody can sign in."""
        return any(token.sha256 and token.is_valid(now_unix_s) for token in self.all)

    def with_new(self, token: Token) -> "Tokens":
        """Return these and one more.

        Raises:
            TokenError: somebody has that name.
        """
        if self.named(token.name) is not None:
            raise TokenError(f"there is a token {token.name} already: revoke it, or take another name")
        return Tokens((*self.all, token))

    def without(self, name: str) -> "Tokens":
        """Return the others.

        Raises:
            TokenError: there is no such token.
        """
        if self.named(name) is None:
            raise TokenError(f"there is no token {name}")
        return Tokens(tuple(token for token in self.all if token.name != name))

    def with_used(self, used: Token) -> "Tokens":
        """Return these, of which one that was for one use signs nobody in any more; its session goes on."""
        return Tokens(tuple(msgspec.structs.replace(one, sha256="") if one == used else one for one in self.all))


def make_token(
    name: str, role: Role, now_unix_s: float, lives_s: float | None = None, *, is_for_one_use: bool = False
) -> tuple[str, Token]:
    """Return a new secret, which nobody keeps, and what is kept of it."""
    secret = secrets.token_urlsafe(_BYTES)
    expires = None if lives_s is None else int(now_unix_s + lives_s)
    return secret, Token(name, role, hashed(secret), int(now_unix_s), expires, is_for_one_use)


class TokenFile:
    """The file that tokens are kept in, readable by the gateway alone."""

    def __init__(self, path: Path) -> None:
        self.path = path

    def mark(self) -> tuple[int, int, int] | None:
        """Return what changes with every writing of the file; None if there is none."""
        try:
            found = self.path.stat()
        except OSError:
            return None
        # The inode, too: each writing puts another file in its place, and two may fall within one tick of the
        # file system's clock.
        return found.st_ino, found.st_mtime_ns, found.st_size

    def read(self) -> Tokens:
        """Return the tokens; none where there is no file.

        Raises:
            ConfigError: it is not a file of tokens.
        """
        try:
            with self.path.open("rb") as file:
                data = file.read(_LONGEST_FILE + 1)
        except FileNotFoundError:
            return Tokens()
        except OSError as error:
            raise ConfigError(f"cannot be read: {error.strerror}", file=str(self.path)) from error
        try:
            return Tokens(msgspec.json.decode(data, type=tuple[Token, ...]))
        except msgspec.DecodeError as error:
            raise ConfigError(f"not a file of tokens: {error}", file=str(self.path)) from error

    def write(self, tokens: Tokens) -> None:
        """Put tokens in the place of those that are there, whole or not at all; only the gateway can read them."""
        write_private(self.path, msgspec.json.format(msgspec.json.encode(tokens.all), indent=2) + b"\n")


def write_private(path: Path, data: bytes) -> None:
    """Write a file that only the owner of its directory can read, whole or not at all."""
    path.parent.mkdir(mode=0o700, parents=True, exist_ok=True)
    # Beside its place: a rename is one step within one file system alone.
    descriptor, name = tempfile.mkstemp(dir=path.parent, prefix=f".{path.name}.")  # 0600
    try:
        with os.fdopen(descriptor, "wb") as file:
            file.write(data)
            file.flush()
            # Before the rename: else a power cut could leave the name with nothing behind it.
            os.fsync(file.fileno())
        if os.geteuid() == 0:  # made by an administrator, read by the gateway's own user
            owner = path.parent.stat()
            os.chown(name, owner.st_uid, owner.st_gid)
        Path(name).replace(path)
    except BaseException:
        Path(name).unlink(missing_ok=True)
        raise
