"""`{cli}`: every command, from click itself. `{schemas}`: the JSON Schemas, also published."""

from __future__ import annotations

import inspect
import json
import re
import shutil
from pathlib import Path
from typing import TYPE_CHECKING, Any

import click
from docutils import nodes
from proofs import MarkdownDirective, table

from certreg.cli.main import cli

if TYPE_CHECKING:
    from collections.abc import Iterator

    from sphinx.application import Sphinx
    from sphinx.util.typing import ExtensionMetadata

SCHEMAS = Path(__file__).resolve().parents[2] / "certreg" / "report" / "schemas"
OPTION = re.compile(r"(?<![`\w-])(--[a-z][a-z-]*)")  # as words they would be set with a dash
PUBLISHED = "schemas"  # the folder of the site that holds them


class CommandLine(MarkdownDirective):
    """All commands with their arguments and options, as `--help` prints them."""

    def run(self) -> list[nodes.Node]:
        """A section for each command."""
        context = click.Context(cli, info_name="certreg")
        commands = (cli.resolve_command(context, [name])[1] for name in cli.list_commands(context))
        return [self._command(command, context) for command in commands if command is not None]

    def _command(self, command: click.Command, parent: click.Context) -> nodes.section:
        context = click.Context(command, info_name=command.name, parent=parent)
        usage = command.get_usage(context).removeprefix("Usage: ")
        usage = " ".join(usage.split())
        options = [
            record
            for parameter in command.get_params(context)
            if (record := parameter.get_help_record(context)) is not None
            and record[1]  # an argument is described in the words above
            and parameter.name != "help"
        ]
        content = [
            nodes.literal_block(usage, usage, language="text", classes=["usage"]),
            *self.markdown(OPTION.sub(r"`\1`", inspect.cleandoc(command.help or ""))),
            _definitions(options),
        ]
        if command.epilog:
            epilog = command.epilog.replace("\b", "").strip("\n")
            content.append(nodes.literal_block(epilog, epilog, language="text"))
        return self.section(f"certreg {command.name}", *content)


def _definitions(records: list[tuple[str, str]]) -> nodes.definition_list:
    shown = nodes.definition_list(classes=["options"])
    for name, meaning in records:
        term = nodes.term("", "", nodes.literal(text=name))
        body = nodes.definition("", nodes.paragraph("", "", *_words(meaning)))
        shown += nodes.definition_list_item("", term, body)
    return shown


def _words(text: str) -> list[nodes.Node]:
    """Words, with the options among them as they are typed."""
    parts = OPTION.split(text)
    return [nodes.literal(text=part) if k % 2 else nodes.Text(part) for k, part in enumerate(parts)]


class Schemas(MarkdownDirective):
    """Each schema: where it is, what it describes, and its keys."""

    def run(self) -> list[nodes.Node]:
        """A section for each schema."""
        return [self._schema(file) for file in sorted(SCHEMAS.glob("*.json"))]

    def _schema(self, file: Path) -> nodes.section:
        schema: dict[str, Any] = json.loads(file.read_text("utf-8"))
        up = "../" * self.env.docname.count("/")
        link = nodes.reference("", file.name, refuri=f"{up}{PUBLISHED}/{file.name}", internal=True)
        header = [nodes.paragraph(text=word) for word in ("key", "value", "meaning")]
        rows = [
            [nodes.literal(text=path), nodes.paragraph(text=kind), self._meaning(meaning)]
            for path, kind, meaning in keys_of(schema)
        ]
        return self.section(
            schema["title"],
            self.prose(schema["description"]),
            nodes.paragraph("", "", nodes.Text("The schema: "), link),
            table(header, rows, (34, 30, 36), "schema"),
        )

    def _meaning(self, words: str) -> nodes.container:
        """What a key means; `> 0` is an inequality, not a quotation."""
        return self.prose(f"\\{words}" if words.startswith(">") else words)


def keys_of(schema: dict[str, Any], prefix: str = "") -> Iterator[tuple[str, str, str]]:
    """Dotted path, kind of value and meaning of every key, those of objects and lists within."""
    for key, value in schema.get("properties", {}).items():
        path = f"{prefix}{key}"
        yield path, kind_of(value), value.get("description", "")
        for choice in value.get("anyOf", [value]):
            yield from keys_of(choice, f"{path}.")
            if isinstance(choice.get("items"), dict):
                yield from keys_of(choice["items"], f"{path}[].")


def kind_of(schema: dict[str, Any]) -> str:
    """What a value may be, in a few words."""
    if "const" in schema:
        return json.dumps(schema["const"])
    if "enum" in schema:
        return " | ".join(json.dumps(value) for value in schema["enum"])
    if "anyOf" in schema:
        return " | ".join(kind_of(choice) for choice in schema["anyOf"])
    kind = schema.get("type", "anything")
    if isinstance(kind, list):
        return " | ".join(kind)
    if kind == "array":
        items, most = schema.get("items"), schema.get("maxItems")
        number = f" of {most}" if most is not None and most == schema.get("minItems") else ""
        return f"array{number}" + (f" ({kind_of(items)})" if isinstance(items, dict) else "")
    return kind


def _publish(app: Sphinx, failure: Exception | None) -> None:
    if failure is None and app.builder.format == "html":
        folder = Path(app.outdir, PUBLISHED)
        folder.mkdir(exist_ok=True)
        for file in SCHEMAS.glob("*.json"):
            shutil.copy(file, folder)


def setup(app: Sphinx) -> ExtensionMetadata:
    """Called by Sphinx."""
    app.add_directive("cli", CommandLine)
    app.add_directive("schemas", Schemas)
    app.connect("build-finished", _publish)
    return {"parallel_read_safe": True, "parallel_write_safe": True}
