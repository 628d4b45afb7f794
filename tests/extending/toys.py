"""Adds toys to copies of the files that docs/extending.md names.

A toy is an extension of one kind, such as a hydrometeor. It may change only the files that the numbered steps of its
section of the page name, and must change all of them. Its new files must lie in folders that the steps name. It may also
change files of tests/, which the page does not count.

  toys.py list TOY...           prints the paths of the copies, below the folder of the copies
  toys.py make FOLDER TOY...    writes the copies, with all the toys in them
"""

from __future__ import annotations

import contextlib
import dataclasses
import pathlib
import re
import sys

SOURCE = pathlib.Path(__file__).resolve().parents[2]
NEW_FILES = pathlib.Path(__file__).resolve().parent / "toys"
PAGE = "docs/extending.md"
PATH = re.compile(r"`((?:server|proto|data|tests)/[A-Za-z0-9_./-]*)`")


class Fault(Exception):
    """A toy that does not follow the page, or that cannot be added to the files."""


@dataclasses.dataclass(frozen=True)
class Edit:
    """Replaces `old`, which occurs once in the file, with `new`.

    `file` is the end of a path that the page names, or the path of a test.
    """

    file: str
    old: str
    new: str

    def apply(self, text: str) -> str:
        count = text.count(self.old)
        if count != 1:
            raise Fault(f"a toy looks for this text in {self.file}, which has it {count} times; "
                        f"adapt the toy in tests/extending/toys.py to the file:\n{self.old}")
        return text.replace(self.old, self.new)


@dataclasses.dataclass(frozen=True)
class Append:
    """Adds text to the end of a file."""

    file: str
    text: str

    def apply(self, text: str) -> str:
        return text + self.text


def after(file: str, anchor: str, added: str) -> Edit:
    return Edit(file, anchor, anchor + added)


@dataclasses.dataclass(frozen=True)
class Toy:
    section: str
    edits: list[Edit | Append]
    # New files of the toy. Each value is the name of a file in the folder toys/ next to this script. Its key is the end
    # of the path of the folder into which the file is copied.
    new_files: dict[str, str] = dataclasses.field(default_factory=dict)
    # Files that the page names and another test of the repository covers.
    elsewhere: tuple[str, ...] = ()


TOYS = {
    "hydrometeor": Toy("A hydrometeor field", [
        Edit("hydrometeors.h", "kGraupel, kHail };", "kGraupel, kHail, kDust };"),
        Edit("hydrometeors.h", "Hydrometeor::kGraupel, Hydrometeor::kHail};",
             "Hydrometeor::kGraupel, Hydrometeor::kHail, Hydrometeor::kDust};"),
        after("hydrometeors.h", "{0.6654F, 0.1119F, 0.0F}}},\n",
              "    HydrometeorRow{\n        Hydrometeor::kDust,\n        \"dust\",\n        1e-5F,\n"
              "        {2e-6F, 2600.0F, 1.0F, {PhaseKind::kHenyeyGreenstein, 0.7F}, {0.5F, 0.4F, 0.2F}}},\n"),
        after("scene.proto", "HYDROMETEOR_HAIL = 6;\n", "  // Dust.\n  HYDROMETEOR_DUST = 7;\n"),
        after("wrf_metadata.cc", '"QGRAUP", "QHAIL"', ', "QDUST"'),
        after("cf_names.cc", 'Named{"hail", Hydrometeor::kHail},\n', '    Named{"dust", Hydrometeor::kDust},\n'),
        after("cf_names.cc", 'Named{"qhail", Hydrometeor::kHail},\n', '    Named{"qdust", Hydrometeor::kDust},\n'),
        after("grib_parameters.cc", 'Density(Hydrometeor::kHail), "HADEN", nullptr, nullptr},\n',
              '    Row{{0, 20, 2}, Ratio(Hydrometeor::kDust), "MASSMR", nullptr, nullptr},\n'),
    ]),
    "parameter": Toy("A parameter of a scene", [
        after("scene.proto", "  Ground ground = 13;\n",
              "  // The irradiance of the moon.\n  optional float moonlight = 14 [(number) = {minimum: 0, maximum: 2, "
              "default_value: 0.25, unit: \"1\"}];\n"),
        after("scene/scene.h", "  Accuracy accuracy;\n", "  double moonlight = 0.25;\n"),
        after("scene_messages.cc", "  scene.accuracy = ToAccuracy(message.accuracy());\n",
              "  scene.moonlight = message.moonlight();\n"),
        after("scene_parts.cc", "constexpr std::array kParts = {\n",
              "    ScenePart{\"moonlight\", Same<&Scene::moonlight>, Stage::kView, false, true},\n"),
        Append("tests/service/scene_parts.txt", "scene.moonlight: moonlight, view, measured error\n"),
    ]),
    "technique": Toy("A technique (a renderer)", [
        after("scene/technique.h", '#include "scene/techniques/cumulus.h"\n', '#include "scene/techniques/fog.h"\n'),
        after("scene/technique.h", "Cumulus, Reference,", " Fog,"),
        after("scene.proto", "    OtherTechnique other = 17;\n", "    // Fog.\n    Fog fog = 18;\n"),
        after("scene.proto", "  map<string, double> numbers = 2;\n}\n",
              "\n// A fog.\nmessage Fog {\n  // Its depth.\n  optional float depth_m = 1 [(number) = {minimum: 1, "
              "maximum: 1000, default_value: 50, unit: \"m\"}];\n  // Whether to paint each field in its false colour.\n"
              "  optional bool false_colors = 2 [(default_on) = false];\n}\n"),
        Edit("technique_messages.cc", "scene::LightVolume ToSettings(",
             "void SetSettings(const scene::Fog& settings, v1::Rendering& rendering) {\n"
             "  rendering.mutable_fog()->set_depth_m(settings.depth_m);\n"
             "  rendering.mutable_fog()->set_false_colors(settings.false_colors);\n}\n\n"
             "scene::Fog ToSettings(const v1::Fog& message) {\n"
             "  return {message.depth_m(), message.false_colors()};\n}\n\n"
             "scene::LightVolume ToSettings("),
        after("technique_messages.cc", "      return scene::Cumulus{};\n",
              "    case v1::Rendering::kFog:\n      return scene::Fog{};\n"),
        after("technique_messages.cc", "      return ToSettings(rendering.cumulus());\n",
              "    case v1::Rendering::kFog:\n      return ToSettings(rendering.fog());\n"),
        Append("tests/service/scene_parts.txt",
               "scene.rendering.fog.depth_m: rendering.technique, view, light correction, measured error\n"
               "scene.rendering.fog.false_colors: rendering.technique, view, light correction, measured error\n"),
    ], {"techniques/": "fog.h"}, elsewhere=("built_in_techniques.cc",)),
    "formula": Toy("A phase function by a formula", [
        after("hydrometeors.h", "  kRayleigh,\n", "  kTilted,\n"),
        after("hydrometeors.h", 'PhaseKindName{PhaseKind::kRayleigh, "rayleigh"},\n',
              '    PhaseKindName{PhaseKind::kTilted, "tilted"},\n'),
        after("optics.cc", "double Rayleigh(double /*g*/, double mu) { return 0.75 * (1.0 + mu * mu); }\n",
              "\ndouble Tilted(double /*g*/, double mu) { return 1.0 + 0.5 * mu; }\n"),
        after("optics.cc", "PhaseFormula{PhaseKind::kRayleigh, false, Rayleigh},\n",
              "    PhaseFormula{PhaseKind::kTilted, false, Tilted},\n"),
        after("scene.proto", "KIND_WATER_NARROW = 8;\n", "    // Tilted.\n    KIND_TILTED = 9;\n"),
        after("tests/service/scene_defaults_test.cc", '{"KIND_RAYLEIGH", PhaseKind::kRayleigh},\n',
              '      {"KIND_TILTED", PhaseKind::kTilted},\n'),
    ]),
    "table": Toy("A phase function by a table", [
        after("hydrometeors.h", "  kRayleigh,\n", "  kMist,\n"),
        after("hydrometeors.h", 'PhaseKindName{PhaseKind::kRayleigh, "rayleigh"},\n',
              '    PhaseKindName{PhaseKind::kMist, "mist"},\n'),
        after("hydrometeors.h", 'PhaseTableName{PhaseKind::kIceColumns, 0.0F, "ice_columns"},\n',
              '    PhaseTableName{PhaseKind::kMist, 0.0F, "mist"},\n'),
        after("recipes.cc", "  std::vector<DropletRecipe> recipes;\n",
              "  recipes.push_back(\n      {.name = \"mist\", .sizes = {2.0, 0.1}, .grid = CloudGrid(), .radii = 40, "
              ".points = 2});\n"),
        after("scene.proto", "KIND_WATER_NARROW = 8;\n", "    // Mist.\n    KIND_MIST = 10;\n"),
        after("tests/service/scene_defaults_test.cc", '{"KIND_RAYLEIGH", PhaseKind::kRayleigh},\n',
              '      {"KIND_MIST", PhaseKind::kMist},\n'),
    ]),
    "call": Toy("A call (rpc)", [
        after("thunderhead.proto", "  rpc RenderImageWithProgress(RenderImageRequest) returns (stream RenderImageEvent);\n",
              "  // Counts the storms.\n  rpc CountStorms(CountStormsRequest) returns (CountStormsResponse);\n"),
        Append("thunderhead.proto",
               "\n// The request of CountStorms.\nmessage CountStormsRequest {\n  // The largest number in the response.\n"
               "  optional uint32 at_most = 1 [(number) = {minimum: 1, maximum: 100, default_value: 100, unit: \"1\"}];\n}\n"
               "\n// The response of CountStorms.\nmessage CountStormsResponse {\n  // The number of storms.\n"
               "  uint32 storms = 1;\n}\n"),
        after("handlers.h", "namespace thunderhead::service {\n",
              "\ngrpc::ServerUnaryReactor* CountStorms(Engine& engine, grpc::CallbackServerContext* context,\n"
              "                                      const CallerRef& caller,\n"
              "                                      const v1::CountStormsRequest* request,\n"
              "                                      v1::CountStormsResponse* response);\n"),
        Edit("thunderhead_service.cc", "using Calls = ", "using Calls = Generated::WithCallbackMethod_CountStorms<"),
        Edit("thunderhead_service.cc", "Generated::Service>", "Generated::Service>>"),
        after("thunderhead_service.cc", "entrance_(access_control, calls) {}\n",
              "\n  grpc::ServerUnaryReactor* CountStorms(grpc::CallbackServerContext* context,\n"
              "                                        const v1::CountStormsRequest* request,\n"
              "                                        v1::CountStormsResponse* response) override {\n"
              "    return entrance_.Unary(\"CountStorms\", context, [&](const CallerRef& caller) {\n"
              "      return service::CountStorms(engine_, context, caller, request, response);\n    });\n  }\n"),
        after("rules.cc", 'Rule{"ListStorms", true, true, true},\n', '    Rule{"CountStorms", true, true, false},\n'),
    ], {"service/": "count_storms.cc"}),
}


def steps_of(section: str) -> str:
    """Returns the numbered steps of a section of the page."""
    text = (SOURCE / PAGE).read_text()
    body = re.search(rf"^## {re.escape(section)}$(.*?)(?=^## |\Z)", text, re.MULTILINE | re.DOTALL)
    if body is None:
        raise Fault(f"{PAGE} has no section '{section}'; tests/extending/toys.py has a toy for it")
    return "\n".join(re.findall(r"^\d+\. .*(?:\n(?!\n|\d+\. ).*)*", body[1], re.MULTILINE))


def named_files(section: str) -> tuple[list[str], list[str]]:
    """Returns the files that the section's steps name, and the folders in which new files may lie."""
    paths = PATH.findall(steps_of(section))
    folders = [path[:path.rindex("/") + 1] if path.endswith("/") else path[:path.index("NAME")]
               for path in paths if path.endswith("/") or "NAME" in path]
    files = [path for path in paths if not path.endswith("/") and "NAME" not in path and not path.startswith("tests/")]
    return sorted(set(files)), folders


def only(paths: list[str], end: str, toy: Toy) -> str:
    """Returns the only path with this end."""
    found = [path for path in paths if ("/" + path).endswith("/" + end)]
    if len(found) != 1:
        raise Fault(f"the toy of '{toy.section}' needs {end}, and the section's steps in {PAGE} name {found or 'no such path'}; "
                    "name every file that such an extension changes, and the folders of its new files")
    return found[0]


def path_of(toy: Toy, file: str) -> str:
    """Returns the path that `file` is the end of, or the path of a test."""
    return file if file.startswith("tests/") else only(named_files(toy.section)[0], file, toy)


def new_path_of(toy: Toy, folder: str) -> str:
    """Returns the path of the toy's new file in the folder whose path ends with `folder`."""
    return only(named_files(toy.section)[1], folder, toy) + toy.new_files[folder]


def origins_of(toy: Toy) -> dict[str, pathlib.Path]:
    """Returns the origin of each copy, by the copy's path. Leaves out what the page should name; `check` reports it."""
    origins: dict[str, pathlib.Path] = {}
    for file in {edit.file for edit in toy.edits}:
        with contextlib.suppress(Fault):
            origins[path_of(toy, file)] = SOURCE / path_of(toy, file)
    for folder, name in toy.new_files.items():
        with contextlib.suppress(Fault):
            origins[new_path_of(toy, folder)] = NEW_FILES / name
    return origins


def check(toy: Toy) -> None:
    """Raises Fault if the page does not name a file that the toy needs, or names one that it does not need."""
    changed = {path_of(toy, edit.file) for edit in toy.edits}
    for folder in toy.new_files:
        new_path_of(toy, folder)
    for path in named_files(toy.section)[0]:
        if path not in changed and pathlib.PurePath(path).name not in toy.elsewhere:
            raise Fault(f"{PAGE}, '{toy.section}', names {path}, which the toy need not change; leave it out or change the toy")


def texts_with(toys: list[Toy]) -> dict[str, str]:
    """Returns the text of each copy, by its path."""
    texts: dict[str, str] = {}
    for toy in toys:
        check(toy)
        for path, origin in origins_of(toy).items():
            texts.setdefault(path, origin.read_text())
        for edit in toy.edits:
            path = path_of(toy, edit.file)
            texts[path] = edit.apply(texts[path])
    return texts


def make(folder: pathlib.Path, toys: list[Toy]) -> None:
    """Writes the copies that have changed."""
    for path, text in texts_with(toys).items():
        file = folder / path
        if file.exists() and file.read_text() == text:
            continue
        file.parent.mkdir(parents=True, exist_ok=True)
        file.write_text(text)


def main(arguments: list[str]) -> int:
    try:
        if arguments[0] == "list":
            print(";".join(sorted({path for name in arguments[1:] for path in origins_of(TOYS[name])})))
        else:
            make(pathlib.Path(arguments[1]), [TOYS[name] for name in arguments[2:]])
    except Fault as fault:
        print(f"toys.py: {fault}", file=sys.stderr)
        return 1
    return 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
