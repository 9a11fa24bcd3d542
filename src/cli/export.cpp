// mortise export: what pictures show of a run, for other programs.
#include <fmt/format.h>

#include <cmath>
#include <filesystem>
#include <iostream>
#include <memory>

#include "cli/commands.h"
#include "cli/frame_range.h"
#include "engine/effect_tables.h"
#include "engine/input.h"
#include "exporters/film.h"
#include "exporters/gltf.h"
#include "exporters/obj.h"
#include "output/field_reader.h"
#include "scene/environments.h"
#include "scene/field_units.h"
#include "scene/quantity.h"
#include "scene/suggest.h"

namespace mortise::cli {
namespace {

namespace fs = std::filesystem;

constexpr double kFilmRate = 25;  // [1/s]

struct ExportOptions {
  std::string run, output, camera, scene, frames, colour_by, range;
  std::vector<std::string> overrides;
  long every = 1;
  double fps = 0;  // 0: not given
  bool overwrite = false;
};

// The field file of a run: the argument, or in that folder.
std::string fields_of(const std::string& run) {
  std::error_code ec;
  if (!fs::is_directory(run, ec)) return run;
  const std::string fields = run + "/fields.vtkhdf";
  if (fs::exists(run + "/env_0000/fields.vtkhdf", ec))
    throw Error(Exit::usage, "'" + run + "' holds several environments: say whose, for example " + run + "/env_0000");
  if (fs::exists(fields, ec)) return fields;
  throw Error(Exit::file, "'" + run + "' has no fields.vtkhdf: it is not the folder of a run");
}

void refuse_existing(const ExportOptions& o, const std::string& path) {
  std::error_code ec;
  if (!o.overwrite && fs::exists(path, ec)) throw Error(Exit::usage, "'" + path + "' exists already; --overwrite replaces it");
}

int film(const ExportOptions& o) {
  refuse_existing(o, o.output);
  const FrameRange range = frame_range(o.frames);
  std::error_code ec;
  const std::string beside = fs::is_directory(o.run, ec) ? o.run : fs::path(o.run).parent_path().string(),
                    folder = (beside.empty() ? "." : beside) + "/frames";
  const auto all = exporters::picture_series(folder);
  std::vector<std::string> names;
  for (const auto& [name, unused] : all) names.push_back(name);
  if (names.empty()) throw Error(Exit::file, "there are no pictures in '" + folder + "'\n  mortise render draws those of a run");
  if (o.camera.empty() && names.size() > 1) throw Error(Exit::usage, "a film of what? --camera " + scene::join(names, ", --camera "));
  const std::string camera = o.camera.empty() ? names[0] : o.camera;
  if (!all.count(camera)) {
    const std::string hint = scene::suggestion(camera, names);
    throw Error(Exit::usage, "'" + folder + "' has no pictures of a camera '" + camera + "'" + (hint.empty() ? "" : "; " + hint));
  }
  std::vector<std::string> chosen;
  for (const std::string& path : all.at(camera)) {
    const std::string stem = fs::path(path).stem().string();
    const long frame = std::stol(stem.substr(stem.rfind('_') + 1));
    if (frame >= range.first && (range.last < 0 || frame <= range.last)) chosen.push_back(path);
  }
  std::vector<std::string> pictures;
  for (std::size_t k = 0; k < chosen.size(); k += static_cast<std::size_t>(o.every)) pictures.push_back(chosen[k]);
  if (pictures.empty()) throw Error(Exit::usage, "--frames " + o.frames + ": there are no such pictures of '" + camera + "'");
  const double fps = o.fps > 0 ? o.fps : kFilmRate;
  exporters::write_film(o.output, pictures, fps);
  std::cout << fmt::format("{}: {} pictures of {}, {:.4g} s\n", o.output, pictures.size(), camera, static_cast<double>(pictures.size()) / fps);
  return 0;
}

// The scale spans the extremes of the field over the exported frames, and zero, where `--range` says nothing else.
exporters::Colouring colouring(const ExportOptions& o, const output::FieldReader& reader, const std::vector<long>& frames) {
  exporters::Colouring out;
  out.field = o.colour_by;
  out.values = [&reader, frames, name = o.colour_by](std::size_t k) { return reader.point_field(name, frames[k]).values; };
  const output::FieldValues first = reader.point_field(o.colour_by, frames[0]);
  if (first.components != 1 && first.components != 3) {
    const std::string hint = scene::suggestion(o.colour_by, reader.point_fields());
    throw Error(Exit::usage,
                "--colour-by " + o.colour_by + ": the run has no such field of numbers or vectors at points" + (hint.empty() ? "" : "; " + hint));
  }
  if (o.range.empty()) {
    out.high = 0;
    for (std::size_t k = 0; k < frames.size(); ++k) {
      const std::vector<double> values = out.values(k);
      for (std::size_t i = 0; i < values.size(); i += static_cast<std::size_t>(first.components)) {
        const double v = first.components == 1 ? values[i] : std::hypot(values[i], values[i + 1], values[i + 2]);
        if (std::isfinite(v)) out.low = std::min(out.low, v), out.high = std::max(out.high, v);
      }
    }
    if (!(out.high > out.low)) out.high = out.low + 1;
  } else {
    const std::size_t colon = o.range.find(':');
    const Unit unit = scene::unit_of_field(o.colour_by).unit;
    const scene::Quantity low = scene::parse_quantity(o.range.substr(0, colon), unit),
                          high = scene::parse_quantity(colon == std::string::npos ? "" : o.range.substr(colon + 1), unit);
    for (const scene::Quantity* q : {&low, &high})
      if (colon != std::string::npos && !q->error.empty())
        throw Error(Exit::usage, "--range " + o.range + ": an end of it " + q->error + (q->hint.empty() ? "" : "\n  " + q->hint));
    if (colon == std::string::npos || !(low.value < high.value))
      throw Error(Exit::usage, "--range " + o.range + ": must be LOW:HIGH, two increasing numbers, e.g. '0:20 kPa'");
    out.low = low.value, out.high = high.value;
  }
  out.map = render::map_for(out.low, out.high);
  return out;
}

int meshes(const ExportOptions& o, const std::string& kind) {
  const std::string fields = fields_of(o.run);
  const output::FieldReader reader(fields);
  const std::vector<scene::EffectTable> tables = engine::effect_tables();
  const scene::Scene scene = o.scene.empty() ? scene::read_scene_text(reader.scene_text(), fields + ": /mortise/scene", o.overrides, tables)
                                             : scene::read_scene(o.scene, o.overrides, tables);
  const model::ModelInput input = engine::make_input(scene.root);
  std::size_t points = 0;
  for (const model::BodyInput& b : input.bodies) points += b.nodes.size();
  if (points != reader.mesh().points.size())
    throw Error(Exit::scene, fmt::format("'{}' holds {} points, the scene's meshes have {}: it is not the result of this scene", fields,
                                         reader.mesh().points.size(), points));
  const FrameRange range = frame_range(o.frames);
  const long last = range.last < 0 ? static_cast<long>(reader.frames()) - 1 : range.last;
  if (range.first < 0 || range.first > last || last >= static_cast<long>(reader.frames()))
    throw Error(Exit::usage, fmt::format("--frames {}:{}: '{}' holds frames 0 to {}", range.first, last, fields, reader.frames() - 1));
  exporters::Frames frames;
  for (long f = range.first; f <= last; f += o.every) frames.numbers.push_back(f), frames.times.push_back(reader.time(f));
  frames.points = [&](std::size_t k) {
    std::vector<double> out;
    for (const Vec3& x : reader.points(frames.numbers[k])) out.insert(out.end(), {x[0], x[1], x[2]});
    return out;
  };
  if (!o.colour_by.empty()) frames.colouring = colouring(o, reader, frames.numbers);
  render::SceneView view(scene.root, input.bodies);
  if (kind == ".glb") {
    refuse_existing(o, o.output);
    exporters::write_gltf(o.output, view, frames, scene.root, o.fps);
    const double size = static_cast<double>(fs::file_size(o.output));
    std::cout << fmt::format("{}: {} bodies, {} frames, {:.3g} {}\n", o.output, view.labels().size(), frames.numbers.size(),
                             size * (size < 1e6 ? 1e-3 : 1e-6), size < 1e6 ? "kB" : "MB");
    return 0;
  }
  const std::string stem = o.output.substr(0, o.output.size() - 4);
  refuse_existing(o, stem + ".mtl");
  for (const long f : frames.numbers) refuse_existing(o, exporters::obj_of_frame(stem, f));
  exporters::write_objs(stem, view, frames);
  std::cout << fmt::format("{} to {}: {} frames\n", exporters::obj_of_frame(stem, frames.numbers.front()),
                           exporters::obj_of_frame(stem, frames.numbers.back()), frames.numbers.size());
  return 0;
}

int cmd_export(const ExportOptions& o) {
  const std::string kind = fs::path(o.output).extension().string();
  const bool is_film = kind == ".mp4" || kind == ".gif";
  if (!is_film && kind != ".glb" && kind != ".obj")
    throw Error(Exit::usage,
                "-o " + o.output + ": must end with .glb (animated glTF), .obj (a file per frame), .mp4 or .gif (a film of a camera's pictures)");
  frame_range(o.frames);
  if (!o.camera.empty() && !is_film) throw Error(Exit::usage, "--camera belongs to films (.mp4, .gif); a " + kind + " file holds the whole scene");
  if (is_film && !o.colour_by.empty()) throw Error(Exit::usage, "--colour-by belongs to meshes (.glb, .obj); in pictures cameras say it: colour_by");
  if (o.colour_by.empty() && !o.range.empty()) throw Error(Exit::usage, "--range needs --colour-by");
  if (kind == ".obj" && o.fps > 0) throw Error(Exit::usage, "--fps has no meaning for a sequence of .obj files");
  if (is_film && !(o.scene.empty() && o.overrides.empty()))
    throw Error(Exit::usage, "a film is made of the pictures that are there; `mortise render` draws others");
  std::error_code ec;
  if (!fs::exists(o.run, ec)) throw Error(Exit::file, "there is no '" + o.run + "'");
  if (const fs::path folder = fs::path(o.output).parent_path(); !folder.empty()) {
    fs::create_directories(folder, ec);
    if (ec) throw Error(Exit::file, "cannot create '" + folder.string() + "': " + ec.message());
  }
  return is_film ? film(o) : meshes(o, kind);
}

}  // namespace

void add_export(Command app, Context& context) {
  const Command sub = app.command("export", "a run as animated glTF, OBJ files or a film, for Blender and others");
  auto o = std::make_shared<ExportOptions>();
  sub.option("run", o->run, "folder of a run, or its fields.vtkhdf").required();
  sub.option("-o,--output", o->output, "NAME.glb, NAME.obj (NAME_0000.obj and so on), NAME.mp4 or NAME.gif").required();
  sub.option("--frames", o->frames, "A:B, A: or A; default all");
  sub.option("--every", o->every, "only every so many of them").positive().show_default();
  sub.option("--fps", o->fps, "frames per second; default: films 25, glTF the times of the run").positive();
  sub.option("--camera", o->camera, "films: whose pictures; those of sensors too");
  sub.option("--colour-by", o->colour_by,
             "glTF and OBJ: bodies in the colours of a field of points, e.g. contact_pressure; vectors by their length. A glTF file then holds a "
             "mesh per frame");
  sub.option("--range", o->range, "LOW:HIGH of that field at the ends of the colours, e.g. '0:20 kPa'; default: its extremes in these frames");
  sub.option("--scene", o->scene, "scene file with other looks, or where its meshes have moved; default: as the run has stored it");
  sub.option("--set", o->overrides, "PATH=VALUE changes one value of the scene, e.g. bodies.pad.visual.color=[1,0,0]").one_each().take_all();
  sub.flag("--overwrite", o->overwrite, "replace files that are there");
  sub.footer(
      "Examples:\n  mortise export out/press -o press.glb                  Blender: File, Import, glTF 2.0\n"
      "  mortise export out/press -o press.glb --fps 24         one frame of the run per frame of the film\n"
      "  mortise export out/press -o press/press.obj --every 5\n"
      "  mortise export out/press -o press.glb --colour-by contact_pressure\n"
      "  mortise export out/press -o press.mp4 --camera beauty  needs ffmpeg");
  sub.action([o, &context] { context.action = [o] { return cmd_export(*o); }; });
}

}  // namespace mortise::cli
