"""The command ``asemd``. One command, one entry of `COMMANDS`; its module is imported when it is used."""
from __future__ import annotations

import importlib
import os
import signal
import sys
import warnings
from collections.abc import Sequence
from typing import Annotated

import typer

from asemd import __version__
from asemd.errors import AsemdError, InputError, InputWarning
from asemd.lammps import command_line
from asemd.lammps import switches as lammps_switches
from asemd.lammps.switches import Switches

# name of the command -> "module:function"; the function is a typer command
COMMANDS: dict[str, str] = {
    "run": "asemd.cli:run",
    "validate": "asemd.cli_inspect:validate",
    "plan": "asemd.cli_inspect:plan",
    "symmetry": "asemd.cli_inspect:symmetry",
    "styles": "asemd.cli_inspect:styles",
    "doctor": "asemd.cli_inspect:doctor",
    "convert": "asemd.cli_convert:convert",
    "check": "asemd.cli_check:check",
    "report": "asemd.cli_report:report",
    "cite": "asemd.cli_cache:cite",
    "cache": "asemd.cli_cache:cache",
}
INTERRUPTED = 130


def main(arguments: Sequence[str] | None = None) -> int:
    """Run one command line.

    Returns
    -------
    int
        Exit status: 0 fine, 1 failed (the last line printed says why), 130 interrupted.
    """
    words = list(sys.argv[1:] if arguments is None else arguments)
    try:
        # LAMMPS's switches have one dash and several values, which typer cannot read: they are taken out first
        words, taken = command_line.split(words, COMMANDS)
        return int(application(words)(words, standalone_mode=False, obj=taken) or 0)
    except KeyboardInterrupt:
        return complain("interrupted", INTERRUPTED)
    except AsemdError as e:
        if os.environ.get("ASEMD_DEBUG"):
            raise
        for problem in getattr(e, "problems", [e]):
            complain(str(problem))
        return 1
    except MemoryError:
        return complain("not enough memory: fewer atoms, a shorter cutoff, or --precision mixed may help")
    except RecursionError:
        return complain("a formula or list is nested too deeply")
    except Exception as e:
        if hasattr(e, "format_message"):        # typer: a wrong option; the help text, which it prints by itself, comes without a message
            return complain(e.format_message() or "a command is missing")
        if os.environ.get("ASEMD_DEBUG"):
            raise
        return complain(f"{type(e).__name__}: {' '.join(str(e).split())} (ASEMD_DEBUG=1 shows where)")


def show_warning(message, category, *place) -> None:
    """Warnings of what the user gave, without the line of code that found it."""
    if issubclass(category, InputWarning):
        print(f"WARNING: {message}", file=sys.stderr, flush=True)
    else:
        sys.stderr.write(warnings.formatwarning(message, category, *place[:2]))


def entry() -> None:
    """The console script."""
    warnings.showwarning = show_warning
    if hasattr(sys.stdout, "reconfigure"):
        sys.stdout.reconfigure(errors="replace")        # terminals that do not have all letters
    sys.exit(main())


def complain(message: str, status: int = 1) -> int:
    """Print the last line; returns the exit status."""
    sys.stdout.flush()
    print(f"ERROR: {message}", file=sys.stderr, flush=True)
    return status


def application(words: list[str]) -> typer.Typer:
    """The typer application with the command that is asked for, or with all of them for the help text."""
    app = typer.Typer(name="asemd", help="LAMMPS input scripts as ASE objects.", add_completion=False, no_args_is_help=True,
                      pretty_exceptions_enable=False)
    app.callback()(_options)
    for name in [w for w in words if w in COMMANDS][:1] or COMMANDS:
        module, _, function = COMMANDS[name].partition(":")
        app.command(name)(getattr(importlib.import_module(module), function))
    return app


def _show_version(wanted: bool) -> None:
    if wanted:
        print(f"asemd {__version__}")
        raise typer.Exit


Version = Annotated[bool, typer.Option("--version", callback=_show_version, is_eager=True, help="Print the version.")]


def _options(version: Version = False) -> None:
    """LAMMPS input scripts as ASE objects."""


def run(context: typer.Context,
        script: Annotated[str | None, typer.Argument(help="LAMMPS input script.")] = None,
        threads: Annotated[int, typer.Option(help="Number of threads.", min=1)] = 1,
        precision: Annotated[str, typer.Option(help="double, or mixed: pair forces in single precision.")] = "double",
        steps_cap: Annotated[int | None, typer.Option(help="Limit on the steps of every run and minimisation.", min=0)] = None,
        log: Annotated[str | None, typer.Option(help="Log file, none for none.")] = None,
        quiet: Annotated[bool, typer.Option("--quiet", help="Print nothing; the log is written all the same.")] = False,
        compat: Annotated[str | None, typer.Option(help="lammps: its tables of charges, its forces that are no gradient.")] = None,
        dry: Annotated[bool, typer.Option("--dry", help="Read and bind all commands, report all problems, compute nothing.")] = False,
        no_watchdog: Annotated[bool, typer.Option("--no-watchdog", help="Go on also when a run has come apart.")] = False,
        safe: Annotated[bool, typer.Option("--safe", help="For scripts from strangers: no shell, no python, no writing outside.")] = False,
        import_: Annotated[list[str] | None, typer.Option("--import", help="Python file with styles of your own.")] = None,
        html: Annotated[str | None, typer.Option(help="Write a page to look at: curves, timing, plan and a molecule that turns.")] = None,
        engine: Annotated[str, typer.Option(help="asemd, or lammps: hand the script to real LAMMPS if the first step agrees.")] = "asemd",
        ranks: Annotated[int, typer.Option(help="MPI ranks of --engine lammps.", min=1)] = 1,
        no_check: Annotated[bool, typer.Option("--no-check", help="With --engine lammps: do not compare the first step before.")] = False,
        ) -> int:
    """Run a LAMMPS input script (- is standard input; LAMMPS's switches such as -var -in -log -echo -screen -sf are accepted)."""
    from asemd.lammps.session import Session, Stop
    options: Switches = context.obj or Switches()
    options.threads, options.cap = threads, options.cap if steps_cap is None else steps_cap
    options.precision = lammps_switches.one_of(precision, ("double", "mixed"), "--precision")
    if compat is not None:
        options.compat = lammps_switches.one_of(compat, ("lammps",), "--compat")
    if log is not None:
        options.log = log
    import_files(import_)
    path = script or options.input
    if path is None and not options.convert:
        raise InputError("asemd run needs a script: asemd run in.file, or - for standard input (before -var, which takes all words behind "
                         "it that are no file, or with -in)")
    if lammps_switches.one_of(engine, ("asemd", "lammps"), "--engine") == "lammps":
        from asemd.cli_engine import run_lammps
        return run_lammps(path, options, ranks, not no_check, quiet,
                          {"--dry": dry, "--safe": safe, "--html": html, "--steps-cap": options.cap is not None, "--import": import_,
                           "--threads": threads > 1, "--precision": precision != "double", "--no-watchdog": no_watchdog})
    if ranks > 1 or no_check:
        raise InputError("--ranks and --no-check belong to --engine lammps: asemd itself runs in one process, see --threads")
    options.safe = safe
    options.watchdog = options.watchdog and not no_watchdog
    if safe:
        from asemd.lammps.safety import guard
        guard(os.getcwd())
    if html:
        check_page(html, dry)
    if dry:
        return rehearse(path, options)
    if quiet:
        options.screen = "none"
    watcher = make_watcher(options.screen is not None)
    session = Session(switches=options, screen=watcher.write if options.screen is None else None)
    session.observer = watcher
    if isinstance(watcher, Bar):
        from asemd.kernels import generate
        generate.announce = lambda: watcher.write("Compiling what is needed for the first time: some ten seconds, up to a minute ...\n")
    if html:
        from asemd.lammps.record import Record
        session.record = Record()
    status = 0
    with interruptible(session), warnings.catch_warnings():
        warnings.simplefilter("ignore", InputWarning)       # printed as WARNING already
        warnings.simplefilter("ignore", RuntimeWarning)     # of numpy: numbers that overflow are in the output, or end the run
        try:
            if options.convert:
                session.commands("\n".join(options.convert))
            else:
                session.file(path)
        except Stop as stop:
            status = stop.status
        except KeyboardInterrupt:
            session.log.write(f"interrupted at step {session.scene.step}\n")
            status = INTERRUPTED
        except Exception as e:
            watcher.stop()
            for problem in getattr(e, "problems", [e]):
                session.log.to_file(f"ERROR: {problem}\n")
            session.close_dumps()
            write_page(session, html, path, str(e))
            session.log.close()
            raise
    write_page(session, html, path, "interrupted" if status == INTERRUPTED else "")
    session.close()
    return complain("interrupted", INTERRUPTED) if status == INTERRUPTED else status


def check_page(target: str, dry: bool = False) -> None:
    """Refuse a page that could not be written after a long run."""
    if dry:
        raise InputError("--html shows what a run did: leave out --dry")
    folder = os.path.dirname(target) or "."
    if not os.path.isdir(folder) or not os.access(folder, os.W_OK) or os.path.isdir(target):
        raise InputError(f"--html {target}: cannot write a file there")


def write_page(session, target: str | None, script: str | None, error: str) -> None:
    """``--html``: the page of what was run, also when the run ended early; then nothing hides the reason."""
    if not target:
        return
    try:
        from asemd.page.run import page_of_run
        page = page_of_run(session, script if script and script != "-" else "standard input", error)
        session.log.write(f"Page: {page.write(target)}\n")
    except Exception as e:
        if not error or os.environ.get("ASEMD_DEBUG"):
            raise
        session.log.write(f"WARNING: no page was written: {type(e).__name__}: {e}\n")


def rehearse(path: str | None, options: Switches) -> int:
    """``--dry``: print every problem of a script; returns the exit status."""
    from asemd.lammps.dry import DrySession
    if path is None:
        raise InputError("--dry needs a script")
    session = DrySession(options)
    session.rehearse(path)
    for note in session.notes:
        print(f"WARNING: {note}")
    for problem in session.problems:
        complain(str(problem))
    count = len(session.problems)
    print(f"{path}: {count} problem{'s' * (count != 1)}" if count else f"{path}: no problems found")
    return 1 if count else 0


def import_files(paths: Sequence[str] | None) -> None:
    """Execute the files of ``--import``."""
    if paths:
        from asemd.user_styles import import_file
        for path in paths:
            import_file(path)


class interruptible:     # noqa: N801  reads as a word in `with`
    """Within it the first Ctrl-C ends the run in order, the second one at once."""

    def __init__(self, session):
        self.session = session

    def __enter__(self):
        try:
            self.before = signal.signal(signal.SIGINT, self.stop)
        except ValueError:      # not in the main thread
            self.before = None

    def stop(self, *_):
        if self.session.interrupted or not self.session.running:
            raise KeyboardInterrupt
        self.session.interrupted = True

    def __exit__(self, *error):
        if self.before is not None:
            signal.signal(signal.SIGINT, self.before)


class Watcher:
    """Looks at a run without a terminal: prints text as it comes."""

    def __init__(self, silent: bool = False):
        self.silent = silent

    def write(self, text: str) -> None:
        sys.stdout.write(text)
        sys.stdout.flush()

    def start(self, steps: int, unit: str = "steps") -> None:
        """Something of that many steps (or lines of a file) begins."""

    def update(self, done: int) -> None:
        """That many are done."""

    def stop(self) -> None:
        """The run is over."""


class Bar(Watcher):
    """Progress bar with steps per second and time left; text appears above it."""

    def __init__(self):
        super().__init__()
        from rich.console import Console
        self.console = Console(highlight=False, markup=False, soft_wrap=True)
        self.progress = None

    def write(self, text: str) -> None:
        if self.progress is None:
            super().write(text)
        else:
            self.console.print(text, end="")

    def start(self, steps: int, unit: str = "steps") -> None:
        from rich.progress import BarColumn, Progress, TaskProgressColumn, TextColumn, TimeRemainingColumn
        if steps > 0:
            rate = TextColumn("{task.fields[rate]} " + f"{unit}/s")
            self.progress = Progress(BarColumn(), TaskProgressColumn(), rate, TimeRemainingColumn(),
                                     console=self.console, transient=True)
            self.task = self.progress.add_task("run", total=steps, rate="-")
            self.progress.start()

    def update(self, done: int) -> None:
        if self.progress is not None:
            elapsed = self.progress.tasks[0].elapsed or 0.0
            self.progress.update(self.task, completed=done, rate=f"{done / elapsed:.4g}" if elapsed > 0.0 else "-")

    def stop(self) -> None:
        if self.progress is not None:
            self.progress.stop()
            self.progress = None


def make_watcher(silent: bool) -> Watcher:
    """A progress bar on a terminal, plain text elsewhere."""
    return Bar() if sys.stdout.isatty() and not silent else Watcher(silent)


if __name__ == "__main__":
    entry()
