"""Scene files (TOML) to scenes, with faults named by their place."""

import difflib
import re
import tomllib
from importlib import resources
from importlib.resources.abc import Traversable
from pathlib import Path
from typing import Any, get_args

import msgspec

from capacity import InputError, Material, Section, parse_material, parse_section
from capacity.units import QUANTITIES
from scene.checks import check
from scene.grids import spelled_out
from scene.model import Scene
from scene.quantities import Quantity


def builtin_names() -> list[str]:
    """Names of the scenes that come with the package: the principal ones, sorted, and then their variants."""
    return list(_builtin_files())


def _builtin_files() -> dict[str, Traversable]:
    folder = resources.files("scene").joinpath("builtin")
    files = [*_toml_files(folder), *_toml_files(folder.joinpath("variants"))]
    return {file.name.removesuffix(".toml"): file for file in files}


def _toml_files(folder: Traversable) -> list[Traversable]:
    return sorted((file for file in folder.iterdir() if file.name.endswith(".toml")), key=lambda file: file.name)


def builtin_text(name: str) -> str:
    """The file of a built-in scene.

    Raises
    ------
    InputError
        When there is no such scene.
    """
    files = _builtin_files()
    if name not in files:
        near = difflib.get_close_matches(name, files, n=1, cutoff=0.5)
        hint = f"did you mean {near[0]}? " if near else ""
        cure = f"{hint}The built-in scenes are {', '.join(files)}; a file of your own ends in .toml"
        raise InputError("scene", f'there is no scene "{name}"', cure)
    return files[name].read_text(encoding="utf-8")


def load_scene(name: str) -> Scene:
    """A scene by the path of its TOML file or by its built-in name.

    Raises
    ------
    InputError
        When the file is missing or anything in it cannot be used; the message names the place and the cure.
    """
    if not name.endswith(".toml"):
        return parse_scene(builtin_text(name), name)
    try:
        # Some editors begin a file with a byte order mark.
        text = Path(name).read_text(encoding="utf-8-sig")
    except FileNotFoundError as error:
        raise InputError(name, "there is no such file", "`ductile scenes NAME > my.toml` writes one to edit") from error
    except (OSError, UnicodeDecodeError) as error:
        raise InputError(name, f"it cannot be read ({error})", "give a text file in UTF-8") from error
    return _beside(parse_scene(text, name), Path(name).parent)


def _beside(scene: Scene, folder: Path) -> Scene:
    """``scene`` with the path of its mesh seen from ``folder``, where its file is."""
    if scene.plane is None or scene.plane.mesh is None:
        return scene
    plane = msgspec.structs.replace(scene.plane, mesh=str(folder / scene.plane.mesh))
    return msgspec.structs.replace(scene, plane=plane)


def parse_scene(text: str, source: str) -> Scene:
    """A scene from TOML text; ``source`` names it in messages."""
    try:
        raw = tomllib.loads(text)
    except tomllib.TOMLDecodeError as error:
        raise InputError(source, f"it is not valid TOML ({error})", "mend that line") from error
    try:
        return check(spelled_out(msgspec.convert(raw, Scene, dec_hook=_read)))
    except msgspec.ValidationError as error:
        raise _explained(error, raw).at(source) from error
    except InputError as error:
        raise error.at(source) from error


def json_schema() -> dict[str, Any]:
    """The JSON schema of scene files; a quantity is text with a unit or an SI number."""
    return msgspec.json.schema(Scene, schema_hook=_schema_of)


def _schema_of(kind: type) -> dict[str, Any]:
    """msgspec's hook for the types it does not know."""
    if issubclass(kind, Quantity):
        _, example = QUANTITIES[kind.kind]
        return {
            "type": ["string", "number"],
            "description": f"{kind.kind}, with a unit or in SI",
            "examples": [example],
        }
    examples = {Section: "IPE 300", Material: "S235"}
    return {"type": "string", "description": f"a {kind.__name__.lower()}", "examples": [examples[kind]]}


def _read(kind: type, value: Any) -> Any:
    """msgspec's hook for the types it does not know."""
    if issubclass(kind, Quantity):
        return kind.read(value)
    if not isinstance(value, str):
        raise InputError("", f"{value!r} is not text", 'write text such as "IPE 300" or "S235"')
    if kind is Section:
        return parse_section(value, "")
    if kind is Material:
        return parse_material(value, "")
    raise NotImplementedError(kind)


def _explained(error: msgspec.ValidationError, raw: dict[str, Any]) -> InputError:
    """The fault that msgspec found, with its place as a user would write it and a cure."""
    message, _, path = str(error).partition(" - at ")
    place = _named(path.strip("`"), str(error), raw)
    cause = error.__cause__
    if isinstance(cause, InputError):
        inner = f"{place} > {cause.place.lstrip(' >')}" if cause.place else place
        return InputError(inner, cause.fault, cause.cure)
    unknown = re.search(r"unknown field `(.+)`", message)
    if unknown:
        known = _known_keys(path)
        near = difflib.get_close_matches(unknown[1], known, n=1, cutoff=0.5)
        hint = f'did you mean "{near[0]}"? ' if near else ""
        return InputError(place or "top level", f'unknown key "{unknown[1]}"', f"{hint}The keys are {', '.join(known)}")
    return InputError(place or "top level", message[0].lower() + message[1:], "see `ductile scenes cantilever`")


def _named(path: str, message: str, raw: dict[str, Any]) -> str:
    """msgspec's path without its ``$``, and with the key that its ``[...]`` leaves open."""
    parts = path.removeprefix("$").lstrip(".")
    head, open_key, tail = parts.partition("[...]")
    if not open_key:
        return parts
    for key, value in raw[head].items():
        try:
            msgspec.convert({**raw, head: {key: value}}, Scene, dec_hook=_read)
        except msgspec.ValidationError as error:
            if str(error) == message:
                return f"{head}.{key}{tail}"
    return parts


def _known_keys(path: str) -> list[str]:
    """Keys that a table may have, by msgspec's path of it."""
    structs = [Scene]
    for key in re.findall(r"\.(\w+)", path):
        structs = [
            inner
            for struct in structs
            for field in msgspec.structs.fields(struct)
            if field.encode_name == key
            for inner in _structs(field.type)
        ]
    return list(dict.fromkeys(field.encode_name for struct in structs for field in msgspec.structs.fields(struct)))


def _structs(kind: Any) -> list[Any]:
    """The structs that a type is, or is made of."""
    if isinstance(kind, type) and issubclass(kind, msgspec.Struct):
        return [kind]
    return [struct for inner in get_args(kind) for struct in _structs(inner)]
