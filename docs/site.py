"""Pages of the site that are no files, made while it is built: filters, examples, the gallery, the way in.

A hook of MkDocs, named in mkdocs.yml.
"""

import ast
import re
from pathlib import Path

from mkdocs.config.defaults import MkDocsConfig
from mkdocs.structure.files import File, Files
from mkdocs.structure.pages import Page

ROOT = Path(__file__).parents[1]
#: What the page for programs says, in this order.
_CALLED = (
    "io.reader.read",
    "io.writer.write",
    "pipeline.one_line.optimize",
    "pipeline.stage.apply_filter",
    "pipeline.pipeline.Pipeline",
    "pipeline.one_line.report",
    "batch.run.run_batch",
    "mesh.mesh.TetMesh",
    "mesh.mesh.SurfaceMesh",
    "mesh.mesh.Cells",
    "meshing.well_center.well_center",
    "meshing.well_center_options.WellCenterOptions",
    "measure.quality",
    "measure.duals",
    "measure.exterior",
    "certify.certificate",
)
_ROLE = re.compile(r":(?:class|func|meth|mod|attr|data|exc):<code>~?(?:[\w.]+\.)?(\w+)</code>")
_LINK = re.compile(r"\[([^\]]*)\]\(([^)#\s]+)(#[^)\s]*)?\)")


def on_config(config: MkDocsConfig) -> MkDocsConfig:
    """Put the filters' pages below their table."""
    for section in config.nav or []:
        for entry in section.get("Reference", []):
            if isinstance(entry, dict) and "Filters" in entry:
                entry["Filters"] = ["filters/index.md", *(name for name in _filter_pages() if "index" not in name)]
    return config


def on_page_content(html: str, page: Page, config: MkDocsConfig, files: Files) -> str:
    """Names that docstrings refer to, without the marks that Sphinx wants there."""
    return _ROLE.sub(r"<code>\1</code>", html)


def on_files(files: Files, config: MkDocsConfig) -> Files:
    """Add the pages that are made; the README is the first, as the index is for those who read files."""
    if listing := files.get_file_from_path("index.md"):
        files.remove(listing)
    for name, text in {
        **_filter_pages(),
        **_example_pages(),
        "index.md": _home(),
        "reference.md": _reference(),
    }.items():
        files.append(File.generated(config, name, content=text))
    return files


def on_page_markdown(markdown: str, page: Page, config: MkDocsConfig, files: Files) -> str:
    """Let links of the documents, as they are read in a clone, lead to the pages of the site."""
    return _LINK.sub(lambda found: _relinked(found, page.file.src_uri, files), markdown)


def _relinked(found: re.Match[str], source: str, files: Files) -> str:
    """A link of the page ``source`` as the site has it; its text alone where it leads to a file that is no page."""
    text, target, anchor = found[1], found[2], found[3] or ""
    path = (ROOT / "docs" / source).parent.joinpath(target).resolve()
    if ":" in target or not path.is_relative_to(ROOT):
        return found[0]
    name = path.relative_to(ROOT).as_posix()
    up = "../" * source.count("/")
    if name in ("docs/index.md", "README.md"):
        return f"[{text}]({up}index.md)"
    if name == "docs/filters.md":
        of = re.fullmatch("#filters(.+)", anchor)
        return f"[{text}]({up}filters/{of[1] if of else 'index'}.md)"
    if name.startswith("docs/") or files.get_file_from_path(name.removeprefix("docs/")):
        return found[0]
    made = f"examples/{path.stem}.md"
    if name.startswith("examples/") and files.get_file_from_path(made):
        return f"[{text}]({up}{made})"
    return text


def _filter_pages() -> dict[str, str]:
    """A page per filter, as ``wct filters`` prints it, and the table of them all."""
    head, *parts = re.split(r"^## (?=filters\.)", (ROOT / "docs/filters.md").read_text(encoding="utf-8"), flags=re.M)
    pages = {}
    for part in parts:
        name = part.split("\n", 1)[0].removeprefix("filters.").strip()
        pages[f"filters/{name}.md"] = f"# {part}".replace("](#filters", "](").replace("(formats.md", "(../formats.md")
        head = head.replace(f"(#filters{name})", f"({name}.md)")
    return {"filters/index.md": head, **pages}


def _example_pages() -> dict[str, str]:
    """A page per example, and the gallery that leads to them."""
    pages, rows = {}, []
    for path in sorted((ROOT / "examples").glob("*.py")):
        source = path.read_text(encoding="utf-8")
        said = ast.get_docstring(ast.parse(source)) or ""
        first, _, rest = said.partition("\n")
        title = first.rstrip(".")
        code = source.split('"""', 2)[2].strip()
        pages[f"examples/{path.stem}.md"] = (
            f"# {path.stem.replace('_', ' ').capitalize()}\n\n{first}\n{_plain(rest)}\n\n```python\n{code}\n```\n"
        )
        rows.append(f"| [{path.stem.replace('_', ' ')}](examples/{path.stem}.md) | {_plain(title)} |")
    head = (
        "# Gallery\n\n"
        "![A bone cut open before and after: red tets do not contain their circumcenter, blue ones do](bone.png)\n\n"
        "Every example runs as it stands, asserts what it prints, and is run by the tests.\n\n| | |\n|---|---|\n"
    )
    return {"gallery.md": head + "\n".join(rows) + "\n", **pages}


def _plain(text: str) -> str:
    """Text of a docstring as Markdown."""
    return text.replace("``", "`")


def _home() -> str:
    """The README, as the site's first page."""
    text = (ROOT / "README.md").read_text(encoding="utf-8")
    text = text.replace("(docs/index.md)", "(docs/gallery.md)").replace("[docs/index.md]", "[the gallery]")
    seen_from_docs = re.sub(r"\]\((?!docs/|\w+:)", "](../", text)
    return seen_from_docs.replace("(docs/", "(")


def _reference() -> str:
    """What a program calls, from docstrings."""
    return "# Python\n\n" + "\n\n".join(f"::: wct_plugin.{name}" for name in _CALLED) + "\n"
