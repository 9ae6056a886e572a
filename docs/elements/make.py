#!/usr/bin/python3
# SPDX-License-Identifier: LGPL-2.1-or-later
"""Makes the pages of elements, NAME.md in this folder, from what the sources say: the SECTION doc block, and the plugin's pads, properties
and signals.

Usage: meson devenv -C build ../docs/elements/make.py [--check]      (--check: writes nothing, fails if a page is another)
"""
import difflib
import pathlib
import re
import sys

import gi

gi.require_version("Gst", "1.0")
from gi.repository import GLib, GObject, Gst  # noqa: E402

FOLDER = pathlib.Path(__file__).resolve().parent
ROOT = FOLDER.parent.parent

# GST_PARAM_*
CONTROLLABLE = 1 << 9
MUTABLE_READY = 1 << 10

FULL_RANGES = [(GLib.MININT, GLib.MAXINT), (0, GLib.MAXUINT), (GLib.MININT64, GLib.MAXINT64), (0, GLib.MAXUINT64)]
FULL_CAPS_FIELDS = {"width": "[1,2147483647]", "height": "[1,2147483647]", "framerate": "[0/1,2147483647/1]"}


def doc_blocks():
    """Name, source file and text of each SECTION doc block."""
    for source in sorted((ROOT / "gst").rglob("*.cpp")):
        for name, block in re.findall(r"^/\*\*\n \* SECTION:(?:element|provider)-(\w+)\n(.*?)^ \*/$", source.read_text(), re.M | re.S):
            yield name, source.relative_to(ROOT), re.sub(r"^ \* ?", "", block, flags=re.M)


def markdown(block):
    """The block's tags, and its text with references and code as Markdown has them."""
    tags = dict(re.findall(r"^@(\w+): (.*)$", block, re.M))
    text = re.sub(r"^@\w+: .*\n", "", block, flags=re.M)
    text = re.sub(r"^Since: .*\n", "", text, flags=re.M)
    text = re.sub(r"^\|\[\n(?=.*gst-)", "```sh\n", text, flags=re.M)
    text = re.sub(r"^\|\[$", "```", text, flags=re.M)
    text = re.sub(r"^\]\|$", "```", text, flags=re.M)
    text = re.sub(r"#Gst\w+:([\w-]+)", r"`\1`", text)
    text = re.sub(r"#(Gst\w+)", r"`\1`", text)
    return tags, text.strip()


def caps_text(caps):
    """Caps without fields that may be anything; structures with the same fields together."""
    kinds = {}
    if caps.is_any():
        return "`ANY`"
    for index in range(caps.get_size()):
        structure = caps.get_structure(index)
        features = caps.get_features(index).to_string()
        kind = structure.get_name() + (f"({features})" if features != "memory:SystemMemory" else "")
        # As caps have them, without the types.
        fields = re.findall(r"(?<=, )([\w-]+)=\(\w+\)(\{.*?\}|\[.*?\]|[^,;]*)", structure.to_string())
        text = ", ".join(f"{name}={value.replace(' ', '')}" for name, value in fields if FULL_CAPS_FIELDS.get(name) != value.replace(" ", ""))
        kinds.setdefault(text, []).append(kind)
    return "; ".join(" ".join([", ".join(f"`{kind}`" for kind in names), *([f"with `{fields}`"] if fields else [])]) for fields, names in kinds.items())


def pads(factory):
    """Lines of pads; pads with the same caps in one."""
    rows = {}
    for template in factory.get_static_pad_templates():
        presence = {Gst.PadPresence.ALWAYS: "", Gst.PadPresence.SOMETIMES: ", sometimes", Gst.PadPresence.REQUEST: ", on request"}[template.presence]
        direction = "in" if template.direction == Gst.PadDirection.SINK else "out"
        rows.setdefault(caps_text(template.get_caps()), []).append(f"`{template.name_template}` ({direction}{presence})")
    return [f"- {', '.join(sorted(names))}: {text}" for text, names in sorted(rows.items(), key=lambda row: sorted(row[1]))]


def enum_values(spec):
    """PyGObject before 3.50 has a Python class here, later ones GEnumClass."""
    known = spec.enum_class
    if hasattr(known, "__enum_values__"):
        return [value for _, value in sorted(known.__enum_values__.items())]
    return [value for value in (GObject.enum_get_value(known, i) for i in range(known.minimum, known.maximum + 1)) if value]


def value_text(value, spec):
    if value is None:
        return ""
    if isinstance(value, bool):
        return str(value).lower()
    if spec.value_type.is_a(GObject.TYPE_ENUM):
        return next(f"`{known.value_nick}`" for known in enum_values(spec) if getattr(known, "value", known) == value)
    if isinstance(value, str):
        return f"`{value}`" if value else ""
    return f"{value:g}" if isinstance(value, float) else str(value)


def property_line(spec):
    kind = spec.value_type.name
    blurb = spec.blurb + "."
    if spec.value_type.is_a(GObject.TYPE_ENUM):
        if kind.startswith(("GstSaliency", "GstTact")): # others are known
            values = enum_values(spec)
            blurb = spec.blurb + ": " + "; ".join(f"`{value.value_nick}`: {value.value_name}" for value in values) + "."
        kind = "enum"
    elif hasattr(spec, "minimum") and (spec.minimum, spec.maximum) not in FULL_RANGES:
        kind += f" {value_text(spec.minimum, spec)}..{value_text(spec.maximum, spec)}"
    default = value_text(spec.default_value, spec) if spec.flags & GObject.ParamFlags.WRITABLE and hasattr(spec, "default_value") else ""
    return f"- `{spec.name}` ({kind}{default and f', {default}'}): {blurb}"


def when(specs):
    """A sentence for those properties that may not be set at any time, and for those that controllers may set."""
    kinds = [("Read-only", lambda flags: not flags & GObject.ParamFlags.WRITABLE), ("To be set before PAUSED", lambda flags: flags & MUTABLE_READY),
             ("Controllable", lambda flags: flags & CONTROLLABLE)]
    named = [(text, [f"`{spec.name}`" for spec in specs if has(spec.flags)]) for text, has in kinds]
    return " ".join(f"{text}: {', '.join(names)}." for text, names in named if names)


def features(name):
    """Class and plugin of the element or provider, and tables of what it has."""
    factory = Gst.ElementFactory.find(name) or Gst.DeviceProviderFactory.find(name)
    if factory is None:
        sys.exit(f"there is no {name}: are all plugins built, and on GST_PLUGIN_PATH?")
    rank = f"; rank {Gst.Rank(factory.get_rank()).value_nick}" if factory.get_rank() else ""
    summary = f"`{factory.get_metadata('klass')}`; plugin `{factory.get_plugin_name()}`{rank}."
    if isinstance(factory, Gst.DeviceProviderFactory):
        return summary, []
    kind = factory.load().get_element_type()
    tables = ["## Pads", "", *pads(factory)]
    specs = [spec for spec in GObject.list_properties(kind) if spec.owner_type == kind]
    if specs:
        tables += ["", "## Properties", "", *([when(specs), ""] if when(specs) else []), *map(property_line, specs)]
    signals = [signal for signal in GObject.signal_list_names(kind) if GObject.signal_query(signal, kind).itype == kind]
    if signals:
        tables += ["", "## Signals", "", *(f"- `{signal}`" for signal in signals)]
    return summary, tables


def page(name, source, block):
    tags, text = markdown(block)
    summary, tables = features(name)
    made = f"<!-- Made by docs/elements/make.py from {source}: change it there. -->"
    description = tags["short_description"]
    return "\n".join([f"# {name}", "", made, "", f"{description[0].upper()}{description[1:]}. {summary}", "", text, "", *tables]).rstrip() + "\n"


def main():
    Gst.init(None)
    wrong = []
    pages = {FOLDER / f"{name}.md": page(name, source, block) for name, source, block in doc_blocks()}
    for file, text in pages.items():
        there = file.read_text() if file.exists() else ""
        if "--check" in sys.argv:
            wrong += difflib.unified_diff(there.splitlines(), text.splitlines(), str(file.relative_to(ROOT)), "as made from the sources", lineterm="")
        elif there != text:
            file.write_text(text)
    wrong += [f"{file.relative_to(ROOT)}: no source has this element" for file in sorted(set(FOLDER.glob("*.md")) - set(pages))]
    print("\n".join(wrong) or f"{len(pages)} pages")
    if wrong:
        sys.exit("make them anew: meson devenv -C build ../docs/elements/make.py")


if __name__ == "__main__":
    main()
