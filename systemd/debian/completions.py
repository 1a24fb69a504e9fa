"""What a shell completes of robotctl's first and second words and options: ``completions.py bash|zsh``."""

import sys

from robotd.cli.main import WORDS, whole_parser

_BASH = """# Made from the parser of robotctl.
_robotctl() {{
    local word="${{COMP_WORDS[COMP_CWORD]}}" key="${{COMP_WORDS[1]}}"
    [ "$COMP_CWORD" -gt 2 ] && case "${{COMP_WORDS[2]}}" in -*) ;; *) key="$key ${{COMP_WORDS[2]}}" ;; esac
    local words
    case "$COMP_CWORD:$key" in
        1:*) words="{first}" ;;
{cases}
    esac
    COMPREPLY=($(compgen -W "$words" -- "$word") $(compgen -f -- "$word"))
}}
complete -o filenames -F _robotctl robotctl
"""
_ZSH = """#compdef robotctl
autoload -U +X bashcompinit && bashcompinit
"""


def cases() -> list[str]:
    """Return for each first word what may follow it, and for each verb its options."""
    seconds: dict[str, list[str]] = {}
    lines = []
    for name, parser in whole_parser():
        options = [option for action in parser._actions for option in action.option_strings]  # noqa: SLF001  # no other way
        first, _, second = name.partition(" ")
        if second:
            seconds.setdefault(first, []).append(second)
        lines.append(f'        *:"{name}") words="{" ".join(options)}" ;;')
    return [f'        2:"{first}") words="{" ".join(words)}" ;;' for first, words in seconds.items()] + lines


def main(shell: str) -> None:
    """Print the script for a shell."""
    script = _BASH.format(first=" ".join(WORDS), cases="\n".join(cases()))
    print(script if shell == "bash" else _ZSH + script, end="")


if __name__ == "__main__":
    main(sys.argv[1])
