"""Sphinx extension: tables, pictures and single figures of ``results/``, put into pages when the site is built.

In Markdown::

    ```{result-table} robustness
    :columns: push_n, survival, score
    :where: direction=all
    :caption: Survival by force.
    ```

    ```{result-figure} robustness
    What the picture shows.
    ```

    {result}`median first_training.score where run=naf*` of ten trainings

    ```{result-index} first_training second_training
    ```

A table may be turned: ``:rows:`` are the columns that stay, ``:across:`` names each new column by a template such as
``V1 = {V1}``, and ``:cell:`` is a template of what stands there, ``{score} ({survival})``.
"""

from __future__ import annotations

import os
import re
from collections.abc import Callable
from pathlib import Path
from typing import Any

from docutils import nodes
from docutils.parsers.rst import directives
from docutils.statemachine import StringList
from result_columns import heading, shown
from result_pictures import draw
from result_rows import Row, chosen, figure, without_percent
from sphinx import addnodes
from sphinx.application import Sphinx
from sphinx.util.docutils import SphinxDirective, SphinxRole

from experiments import record

INTERVALS = {"low": "{} ({} to {})", "high": "", "error": "{} ± {}"}
"""How the columns of an interval's ends, or of an error, stand with the column that they belong to."""
PATHS = {"test"}
"""Columns that hold names of files."""
LONG = 30
"""Characters of a cell beyond which it may be broken into lines."""


class ResultDirective(SphinxDirective):
    """What directives of results share: reading one, and saying where it comes from."""

    def read(self, name: str) -> record.Result:
        """Read a result; the page is built anew when its files change."""
        if name not in record.names():
            raise self.error(f"results/{name}.csv does not exist")
        self.env.note_dependency(str(record.RESULTS / f"{name}.csv"))
        return record.read(name)

    def banner(self, *results: record.Result) -> list[nodes.Node]:
        """A note that results are not of today's project, or not complete, once a page."""
        said = self.env.temp_data.setdefault("stale_results", set())
        stale = [result for result in results if result.remark and result.name not in said]
        said.update(result.name for result in stale)
        if not stale:
            return []
        text = nodes.paragraph("", " ".join(dict.fromkeys(str(result.remark) for result in stale)) + " Made by ")
        for result in stale:
            text += nodes.literal("", f"make results NAME={result.name}")
            text += nodes.Text("." if result is stale[-1] else ", ")
        title = nodes.title(
            "", "Not of today's project" if any(not result.missing for result in stale) else "Not complete"
        )
        return [nodes.admonition("", title, text, classes=["warning"])]

    def source(self, result: record.Result) -> list[nodes.Node]:
        """The line below a table, once a page: how to make it again, when it was made, and its data."""
        said = self.env.temp_data.setdefault("sources_of_results", set())
        if result.name in said:
            return []
        said.add(result.name)
        line = nodes.paragraph(classes=["result-source"])
        line += nodes.literal("", f"make results NAME={result.name}")
        line += nodes.Text(f" · made on {result.date} · ")
        data = os.path.relpath(record.RESULTS / f"{result.name}.csv", Path(self.env.doc2path(self.env.docname)).parent)
        link = addnodes.download_reference("", "", reftarget=data, refdoc=self.env.docname)
        link += nodes.Text("data")
        line += link
        return [line]


class ResultTable(ResultDirective):
    """``result-table``: rows of a result."""

    required_arguments = 1
    option_spec = {name: directives.unchanged for name in ("columns", "where", "rows", "across", "cell", "caption")}

    def run(self) -> list[nodes.Node]:
        """The banner if there is need, the table, and where it comes from."""
        result = self.read(self.arguments[0])
        try:
            rows = chosen(result.rows, self.options.get("where", ""))
            if not rows:
                raise ValueError("no such rows")
            is_turned = "across" in self.options
            without_effect = {"columns"} if is_turned else {"rows", "cell"}
            if unused := sorted(without_effect & set(self.options)):
                raise ValueError(f"{unused[0]} has no effect {'with' if is_turned else 'without'} across")
            head, body = self._turned(rows) if is_turned else self._straight(rows)
        except (KeyError, ValueError) as problem:
            raise self.error(f"result-table {result.name}: {problem}") from problem
        table = table_node(head, body)
        title = nodes.title("", *self.state.inline_text(self.options.get("caption", result.question), self.lineno)[0])
        table.insert(0, title)
        return [*self.banner(result), table, *self.source(result)]

    def _straight(self, rows: list[Row]) -> tuple[list[str], list[list[str]]]:
        columns = listed(self.options["columns"]) if "columns" in self.options else list(rows[0])
        columns = [column for column in columns if not is_end(column, rows[0])]
        body = [[cell(column, row, rows) for column in columns] for row in rows]
        return [heading(column) for column in columns], body

    def _turned(self, rows: list[Row]) -> tuple[list[str], list[list[str]]]:
        kept, across, template = listed(self.options["rows"]), self.options["across"], self.options["cell"]
        across_names = list(dict.fromkeys(across.format(**row) for row in rows))
        lines: dict[tuple[str, ...], dict[str, str]] = {}
        for row in rows:
            line = lines.setdefault(tuple(cell(column, row, rows) for column in kept), {})
            line[across.format(**row)] = filled(template, row, rows)
        body = [[*line, *(cells.get(name, "") for name in across_names)] for line, cells in lines.items()]
        return [*map(heading, kept), *across_names], body


class ResultFigure(ResultDirective):
    """``result-figure``: a picture drawn from results; its content is the caption."""

    required_arguments = 1
    has_content = True

    def run(self) -> list[nodes.Node]:
        """The banner if there is need, and the picture."""
        name = self.arguments[0]
        try:
            path, sources = draw(name, picture_folder(self.env.app))
        except KeyError as problem:
            raise self.error(f"result-figure: {problem}") from problem
        results = [self.read(source) for source in sources]
        image = nodes.image(uri=os.path.relpath(path, Path(self.env.doc2path(self.env.docname)).parent))
        image["alt"] = results[0].question
        picture = nodes.figure("", image)
        if self.content:
            caption = " ".join(self.content)
            picture += nodes.caption("", "", *self.state.inline_text(caption, self.lineno)[0])
        return [*self.banner(*results), picture]


class ResultIndex(ResultDirective):
    """``result-index``: the question and the answer of each page that it names."""

    required_arguments = 1
    final_argument_whitespace = True

    def run(self) -> list[nodes.Node]:
        """A list of links to pages, each with the page's first paragraph."""
        lines = []
        for page in self.arguments[0].split():
            path = Path(self.env.doc2path(self.env.docname)).with_name(f"{page}.md")
            self.env.note_dependency(str(path))
            title, answer = re.match(r"# (.+)\n+((?:.+\n)+)", path.read_text(encoding="utf-8")).groups()
            lines.append(f"- [{title}]({page}.md) {' '.join(answer.split())}")
        node = nodes.Element()
        self.state.nested_parse(StringList(lines, self.env.docname), self.content_offset, node)
        return node.children


class FigureRole(SphinxRole):
    """``result``: one figure, see :func:`result_rows.figure`."""

    def run(self) -> tuple[list[nodes.Node], list[nodes.system_message]]:
        """The figure as text."""
        for name in re.findall(r"^\w+ (\w+)", self.text):
            self.env.note_dependency(str(record.RESULTS / f"{name}.csv"))
        try:
            return [nodes.Text(figure(self.text))], []
        except (OSError, ValueError) as problem:
            message = self.inliner.reporter.error(str(problem), line=self.lineno)
            return [self.inliner.problematic(self.rawtext, self.rawtext, message)], [message]


def listed(text: str) -> list[str]:
    """Names that commas separate."""
    return [name.strip() for name in text.split(",")]


def is_end(column: str, row: Row) -> bool:
    """Whether a column is an end of another one's interval, or its error, and stands in that one's cells."""
    stem, _, end = column.rpartition("_")
    return end in INTERVALS and stem in row


def cell(column: str, row: Row, rows: list[Row]) -> str:
    """What a cell shows, with the interval or error that belongs to it."""
    if not row[column]:
        return ""

    def text(name: str) -> str:
        return shown(name, row[name], [other[name] for other in rows])

    for end, template in INTERVALS.items():
        if row.get(f"{column}_{end}"):
            ends = [column, f"{column}_low", f"{column}_high"] if end == "low" else [column, f"{column}_{end}"]
            return template.format(without_percent(text(ends[0]), text(ends[-1])), *map(text, ends[1:]))
    return text(column)


def filled(template: str, row: Row, rows: list[Row]) -> str:
    """A template with a row's cells; brackets in which a cell is empty are left out."""
    cells = {column: cell(column, row, rows) for column in row}
    without = re.sub(
        r"\s*\(([^()]*)\)",
        lambda bracket: bracket[0] if all(cells[name] for name in re.findall(r"\{(\w+)\}", bracket[1])) else "",
        template,
    )
    return without.format(**cells)


def table_node(head: list[str], body: list[list[str]]) -> nodes.table:
    """A table of texts."""
    table = nodes.table(classes=["results"])
    group = nodes.tgroup(cols=len(head))
    table += group
    group += [nodes.colspec(colwidth=1) for _ in head]
    header, rows = nodes.thead(), nodes.tbody()
    group += [header, rows]
    header += table_row(head, [nodes.Text] * len(head))
    kinds = [nodes.literal if name in PATHS else nodes.Text for name in head]
    rows += [table_row(line, kinds) for line in body]
    return table


def table_row(cells: list[str], kinds: list[Callable[[str], nodes.Node]]) -> nodes.row:
    """A row of a table."""
    row = nodes.row()
    for text, kind in zip(cells, kinds, strict=True):
        content = nodes.literal("", text) if kind is nodes.literal else nodes.Text(text)
        row += nodes.entry("", nodes.paragraph("", "", content), classes=["long"] if len(text) > LONG else [])
    return row


def picture_folder(app: Sphinx) -> Path:
    """Folder for pictures, beside the site: nothing is written to the sources."""
    folder = Path(app.outdir).parent / "results"
    folder.mkdir(parents=True, exist_ok=True)
    return folder


def setup(app: Sphinx) -> dict[str, Any]:
    """Make the directives and the role known."""
    app.add_directive("result-table", ResultTable)
    app.add_directive("result-figure", ResultFigure)
    app.add_directive("result-index", ResultIndex)
    app.add_role("result", FigureRole())
    app.add_css_file("results.css")
    return {"version": "1", "parallel_read_safe": True, "parallel_write_safe": True}
