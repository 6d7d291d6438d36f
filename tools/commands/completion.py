"""`surefoot completion`: the Tab key of a shell."""

from __future__ import annotations

import argparse

_COMPLETION = """\
Print what a shell needs to complete `surefoot`: commands, options and choices, files where a file is meant, the
names of the deployments in config/. It is made from the parser itself; print it anew after an update.

exit code: 0 printed; 2 the call was wrong
"""

_EXAMPLES = """\
examples: surefoot completion bash > ~/.local/share/bash-completion/completions/surefoot
          surefoot completion zsh > ~/.zfunc/_surefoot
          surefoot completion tcsh > ~/.surefoot.csh
"""


def add(commands: argparse._SubParsersAction) -> None:
    """Add the command to the parser."""
    parser = commands.add_parser(
        "completion",
        help="what a shell needs to complete these commands",
        formatter_class=argparse.RawDescriptionHelpFormatter,
        description=_COMPLETION,
        epilog=_EXAMPLES,
    )
    parser.add_argument("shell", choices=("bash", "zsh", "tcsh"))
    parser.set_defaults(run=_run)


def _run(call: argparse.Namespace) -> int:
    from surefoot.tools.cli import make_parser
    from surefoot.tools.completion import script

    print(script(make_parser(), call.shell))
    return 0
