"""The page of commands, from what the command line itself tells."""

from __future__ import annotations

from typing import Any

import typer.main

HEAD = """# Commands

`jaxbacklash COMMAND --help` prints the same. Exit code 0 means done, 2 bad input, 1 no answer, 130 stopped with Ctrl-C; every
error is one sentence that says what to type next. `jaxbacklash --version` prints the version.

Options that tell how a file is read (`--columns` to `--to`) are the same for every command that reads a record; they are
listed [once, at the end](#reading-files).
"""


def page() -> str:
    """The page as Markdown: one section a command, with its example and its options."""
    from jaxbacklash.cli import app

    commands = typer.main.get_command(app).commands  # type: ignore[attr-defined]
    shared = reading_options()
    parts = [HEAD]
    for name, command in commands.items():
        own = [one for one in command.params if option(one) not in shared]
        example = (command.epilog or "").removeprefix("Example: ")
        parts.append(f"## {name}\n\n{command.help}\n\n```sh\n{example}\n```\n\n{table(own)}")
        if len(own) < len(command.params):
            parts[-1] += "\nIt also takes the options for [reading files](#reading-files).\n"
    readers = [one for one in commands["look"].params if option(one) in shared]
    return "\n".join([*parts, f"## Reading files\n\n{table(readers)}"])


def reading_options() -> set[str]:
    """The options that every command which reads a record has."""
    from jaxbacklash.commands.reading import _OPTIONS

    return set(_OPTIONS.values())


def option(one: Any) -> str:
    """How a parameter is typed: its longest option, or its name where it stands by its place."""
    return max(one.opts, key=len) if one.opts and one.opts[0].startswith("-") else str(one.name).upper()


def table(params: list[Any]) -> str:
    """Name, meaning and default of each parameter."""
    rows = ["| option | what it says | default |", "|---|---|---|"]
    for one in params:
        default = "" if one.default is None or callable(one.default) or one.default is False else f"`{shown(one.default)}`"
        required = "**required**" if one.required else default
        rows.append(f"| `{option(one)}` | {cell(getattr(one, 'help', '') or '')} | {required} |")
    return "\n".join(rows) + "\n"


def shown(default: Any) -> str:
    return str(getattr(default, "value", default))


def cell(text: str) -> str:
    """Text for a cell of a Markdown table."""
    return text.replace("|", "\\|").replace("<", "&lt;").replace("*", "\\*").replace("_", "\\_")
