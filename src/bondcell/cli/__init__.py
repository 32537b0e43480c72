"""The command ``bondcell``: exit status 0 good, 1 no value or a missing library, 2 bad input."""

from __future__ import annotations

import argparse
import os
import re
import signal
import sys
from collections.abc import Sequence
from io import TextIOWrapper

from bondcell.errors import BondcellError, InputError

GOOD, FAILED, BAD_INPUT = 0, 1, 2
INTERRUPTED = 128 + signal.SIGINT
BROKEN_PIPE = 128 + 13  # what a shell reports for SIGPIPE

EXAMPLES = """\
examples (a value may carry its unit; bare numbers are SI):
  bondcell stiffness --radius "7.5 mm" --gap "0.5 mm" --young-particle "30 GPa" \\
      --poisson-particle 0.25 --young-matrix "1.4 MPa" --poisson-matrix 0.46 --model film
  bondcell show results/figure4/study.nc
  bondcell COMMAND --help

exit status: 0 good, 1 a value could not be computed or files differ, 2 bad input
"""

_NUMBER_LIKE = re.compile(r"-(\.?\d|inf|nan)", re.IGNORECASE)


def main(arguments: Sequence[str] | None = None) -> int:
    """Run the command line.

    Parameters
    ----------
    arguments
        Words after the command's name; those of the process by default.

    Returns
    -------
    int
        Exit status: 0 good, 1 an asked value could not be computed, 2 bad input.
    """
    words = sys.argv[1:] if arguments is None else list(arguments)
    for stream in (sys.stdout, sys.stderr):
        if isinstance(stream, TextIOWrapper):  # a terminal may know no Greek letters
            stream.reconfigure(errors="replace")
    try:
        try:
            chosen = parser().parse_args(_with_attached_numbers(words))
            status: int = chosen.run(chosen)
        except SystemExit as leaving:  # argparse leaves this way, also for --help
            status = leaving.code if isinstance(leaving.code, int) else BAD_INPUT
        sys.stdout.flush()
    except InputError as error:
        return _complain(error)
    except BrokenPipeError:
        # The reader went away; what is left in the buffer must not complain again at exit.
        os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())
        return BROKEN_PIPE
    except (BondcellError, OSError) as error:
        print(f"bondcell: {error}", file=sys.stderr)
        return FAILED
    except KeyboardInterrupt:
        print("bondcell: interrupted", file=sys.stderr)
        return INTERRUPTED
    return status


def _complain(error: InputError) -> int:
    source = f"{error.source}: " if error.source else ""
    for violation in error.violations:
        print(f"bondcell: {source}{violation}", file=sys.stderr)
    return BAD_INPUT


def parser() -> argparse.ArgumentParser:
    """The parser of the command line with all subcommands."""
    from bondcell.cli import (
        advise,
        compare,
        merging,
        model_list,
        report_page,
        show,
        stiffness,
        validation,
    )

    words = argparse.ArgumentParser(
        prog="bondcell",
        description="Stiffness of two spheres bonded through a matrix.",
        epilog=EXAMPLES,
        formatter_class=argparse.RawDescriptionHelpFormatter,
        allow_abbrev=False,
    )
    words.add_argument("--version", action=_Version, help="print the version and leave")
    commands = words.add_subparsers(title="commands", metavar="COMMAND", required=True)
    for command in (stiffness, advise, validation, show, compare, merging, report_page, model_list):
        command.add_to(commands)
    return words


class _Version(argparse.Action):
    """Looks the version up only when it is asked for."""

    def __init__(self, option_strings: Sequence[str], dest: str, help: str | None = None) -> None:
        super().__init__(option_strings, dest, nargs=0, help=help)

    def __call__(self, parser: argparse.ArgumentParser, *_: object) -> None:
        import bondcell

        print(f"bondcell {bondcell.__version__}")
        parser.exit()


def _with_attached_numbers(words: Sequence[str]) -> list[str]:
    """Join an option with a negative value, which argparse would take for an option.

    Examples
    --------
    >>> _with_attached_numbers(["--gap", "-5e-4", "--radius", "7.5 mm"])
    ['--gap=-5e-4', '--radius', '7.5 mm']
    """
    joined: list[str] = []
    for word in words:
        follows_option = joined and joined[-1].startswith("--") and "=" not in joined[-1]
        if follows_option and _NUMBER_LIKE.match(word):
            joined[-1] += f"={word}"
        else:
            joined.append(word)
    return joined
