#!/usr/bin/env python3
"""Holds the library to its layers: layers_test.py SOURCE_FOLDER

Every folder of include/pcor, src and tests is a module of layers.txt or a workshop (tests of the whole); a module includes
modules of lower layers and itself; no files include each other in a circle; a header of src, which is not installed, is
included by no installed one and keeps its names in pcor::internal, except types that an installed header declares; no installed
header names pcor::internal; no include climbs through ".."; no two headers define one type;
and one file of src calls the netCDF C library.
docs/architecture.md describes the same modules.
"""
import pathlib
import re
import sys

root = pathlib.Path(sys.argv[1])
layers = [line.split() for line in (root / "tests/architecture/layers.txt").read_text().splitlines() if line and line[0] != "#"]
layer_of = {module: number for number, layer in enumerate(layers) for module in layer}
workshops = {"clients", "foreign", "fuzz", "hidden", "hostile", "package", "python", "real", "architecture", "support", "tool"}  # tests of no single module
trouble = []
DECLARED = re.compile(r"^(?:class|struct) (\w+);", re.MULTILINE)
DEFINED = re.compile(r"^(?:class|struct) (\w+)(?: final)?(?: :[^:][^;{]*)? \{", re.MULTILINE)
types = {}  # first header that defines a type, by namespace and name


def sources(folder):
    return sorted(path for path in (root / folder).rglob("*.[ch]pp"))


declared = {name for path in sources("include") for name in DECLARED.findall(path.read_text())}


def public_names(text):
    """Beginnings of the lines of a header's declarations in namespace pcor, not in one nested in it."""
    nested = []
    for line in text.splitlines():
        if opened := re.match(r"namespace ([\w:]+) \{", line):
            nested.append(opened.group(1))
        elif line.startswith("}  // namespace"):
            nested.pop()
        elif nested == ["pcor"] and re.match(r"\w", line):
            yield line


def included_by(path):
    for number, line in enumerate(path.read_text().splitlines(), 1):
        match = re.match(r'\s*#\s*include\s*(?:<(pcor/[^>]+)>|"([^"]+)")', line)
        if match:
            public, private = match.groups()
            target = root / "include" / public if public else root / "src" / private
            yield number, target


for folder in ("include", "src", "tests", "tools", "benchmarks"):
    for path in sources(folder):
        text = path.read_text()
        where = path.relative_to(root)
        if re.search(r'#\s*include\s*["<]\.\./', text):
            trouble.append(f"{where}: an include climbs through ..; name headers of src from src")
        opens = re.findall(r"^namespace (pcor(?:::\w+)*) \{", text, re.MULTILINE)
        if folder == "src" and path.suffix == ".hpp":
            for line in public_names(text):
                name = DEFINED.match(line) or DECLARED.match(line)
                if not name or name.group(1) not in declared:
                    trouble.append(f"{where}: what is not installed belongs in pcor::internal: {line}")
        calls_c_library = re.search(r"\bnc_[a-z_0-9]+\s*\(|#\s*include\s*<netcdf\.h>", text)
        if folder == "src" and calls_c_library and path.name != "netcdf_c.cpp":
            trouble.append(f"{where}: calls the netCDF C library; use netcdf-cxx4, and what that lacks from flight/netcdf_c.hpp")
        if folder == "include" and re.search(r"\binternal::|\bnamespace (\w+::)*internal\b", text):
            trouble.append(f"{where}: an installed header names pcor::internal")

        if folder in ("include", "src") and path.suffix == ".hpp":
            for type_name in DEFINED.findall(text):
                first = types.setdefault((*opens, type_name), where)
                if first != where:
                    trouble.append(f"{where}: {'::'.join(opens)}::{type_name} is also a type of {first}; the linker keeps one of them")

for folder in ("include/pcor", "src", "tests"):
    for child in sorted((root / folder).iterdir()):
        known = set(layer_of) | (workshops if folder == "tests" else set())
        if child.is_dir() and child.name not in known:
            trouble.append(f"{folder}/{child.name} is not a module in tests/architecture/layers.txt")

described, layer = {}, -1
for number, module in re.findall(r"^\| (\d*) *\| `(\w+)` \|", (root / "docs/architecture.md").read_text(), flags=re.MULTILINE):
    layer = int(number) if number else layer
    described[module] = layer
if described != layer_of:
    trouble.append("docs/architecture.md has other modules than tests/architecture/layers.txt: "
                   f"{sorted(set(described.items()) ^ set(layer_of.items()))}")

includes = {}
for folder in ("include/pcor", "src"):
    base = root / folder
    for path in sources(folder):
        module = path.relative_to(base).parts[0]
        where = path.relative_to(root)
        includes[path] = []
        for number, target in included_by(path):
            if not target.exists():
                trouble.append(f"{where}:{number}: there is no {target.relative_to(root)}; name headers of src from src")
                continue
            includes[path].append(target)
            area = root / "include/pcor" if (root / "include") in target.parents else root / "src"
            other = target.relative_to(area).parts[0]
            if other != module and layer_of.get(other, 99) >= layer_of.get(module, -1):
                trouble.append(f"{where}:{number}: the module {module} includes {target.relative_to(root)}, "
                               f"includes the module {other}, which is not below it")
            if folder == "include/pcor" and area == root / "src":
                trouble.append(f"{where}:{number}: an installed header includes one that is not installed")

done = set()


def follow(path, way):
    if path in way:
        circle = way[way.index(path):] + [path]
        trouble.append("a circle: " + " includes ".join(str(each.relative_to(root)) for each in circle))
        return
    if path in done:
        return
    for target in includes.get(path, []):
        follow(target, way + [path])
    done.add(path)


for path in includes:
    follow(path, [])

print("\n".join(trouble) if trouble else f"{len(includes)} files keep to {len(layers)} layers of {len(layer_of)} modules")
sys.exit(1 if trouble else 0)
