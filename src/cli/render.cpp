// mortise render: pictures of a run that is already on disk, with the same or other cameras.
#include <fmt/format.h>

#include <memory>
#include <optional>

#include "cli/commands.h"
#include "cli/frame_range.h"
#include "engine/effect_tables.h"
#include "engine/input.h"
#include "output/field_reader.h"
#include "run/pictures.h"
#include "run/sensor_maps.h"
#include "scene/environments.h"

namespace mortise::cli {
namespace {

struct RenderOptions {
  std::string scene, fields, output;
  std::vector<std::string> overrides;
  long first = 0, last = -1, every = 0;  // every 0: as the scene says
  long environment = -1;
};

// What the file holds of the sensors' readings in one frame.
std::vector<sensors::Reading> readings_of(const output::FieldReader& reader, const sensors::Sensors& sensors, long frame, const std::string& fields) {
  std::vector<sensors::Reading> out;
  for (const sensors::Sensor& s : sensors.all()) {
    const auto rows = [&](const char* name, int components) {
      output::FieldValues v = reader.rows("sensor_" + s.name(), name, frame);
      if (v.values.size() != static_cast<std::size_t>(s.spec().taxels()) * components)
        throw Error(Exit::scene, fmt::format("'{}' has no {} of a sensor '{}' with {} x {} taxels: it is not the result of this scene", fields, name,
                                             s.name(), s.spec().rows, s.spec().columns));
      return std::move(v.values);
    };
    sensors::Reading& r = out.emplace_back();
    r.pressure = rows("pressure", 1), r.shear = rows("shear", 2), r.area = rows("area", 1);
  }
  return out;
}

int cmd_render(const RenderOptions& o) {
  const std::vector<scene::EffectTable> tables = engine::effect_tables();
  scene::Scene scene = scene::read_scene(o.scene, o.overrides, tables);
  if (o.environment >= 0)
    scene = scene::one_environment(scene, o.overrides, tables, o.environment);
  else if (scene::environment_count(scene.root) > 0)
    throw Error(Exit::usage,
                "the scene has several environments: say whose fields these are, for example --environment 0 with env_0000/fields.vtkhdf");
  const Params* render = scene.root.find("render");
  if (!render && !scene.root.has("sensors"))
    throw Error(Exit::scene, scene.root.where(), "the scene has no 'render' block: there is no camera to draw with, and no sensor to draw");
  const output::FieldReader reader(o.fields);
  const model::ModelInput input = engine::make_input(scene.root);
  std::size_t nodes = 0;
  for (const model::BodyInput& b : input.bodies) nodes += b.nodes.size();
  if (nodes != reader.mesh().points.size())
    throw Error(Exit::scene, fmt::format("'{}' holds {} points, the scene's meshes have {}: it is not the result of this scene", o.fields,
                                         reader.mesh().points.size(), nodes));
  const long last = o.last < 0 ? static_cast<long>(reader.frames()) - 1 : o.last;
  if (o.first > last || last >= static_cast<long>(reader.frames()))
    throw Error(Exit::usage, fmt::format("--frames {}:{}: '{}' holds frames 0 to {}", o.first, last, o.fields, reader.frames() - 1));

  const std::string folder =
      !o.output.empty() ? o.output : o.fields.substr(0, o.fields.rfind('/') == std::string::npos ? 0 : o.fields.rfind('/') + 1) + "frames";
  const long every = o.every > 0 ? o.every : render ? render->integer("every") : 1;
  const sensors::Sensors sensors(input);
  std::optional<run::Pictures> pictures;
  std::optional<run::SensorMaps> maps;
  if (render && render->has("cameras")) pictures.emplace(scene.root, input, folder);
  if (!sensors.empty()) maps.emplace(scene.root, sensors, folder);
  for (long f = 0; maps && f < o.first; ++f) maps->see(readings_of(reader, sensors, f, o.fields));  // their scales know what was before
  for (long f = o.first; f <= last; ++f) {
    const bool drawn = (f - o.first) % every == 0;
    if (maps) {
      const std::vector<sensors::Reading> readings = readings_of(reader, sensors, f, o.fields);
      maps->see(readings);
      if (drawn) maps->draw(f, reader.time(f), readings);
    }
    if (!pictures || !drawn) continue;
    std::vector<double> points;
    for (const Vec3& x : reader.points(f)) points.insert(points.end(), {x[0], x[1], x[2]});
    std::map<std::string, std::vector<double>> fields;
    for (const std::string& name : reader.point_fields()) {
      output::FieldValues values = reader.point_field(name, f);
      if (values.components == 1 || values.components == 3) fields[name] = std::move(values.values);
    }
    pictures->draw(f, reader.time(f), points, fields);
  }
  return 0;
}

}  // namespace

void add_render(Command app, Context& context) {
  const Command sub = app.command("render", "draw pictures from saved fields, e.g. with another camera or other scales");
  auto o = std::make_shared<RenderOptions>();
  auto frames = std::make_shared<std::string>();
  add_scene_options(sub, o->scene, o->overrides);
  sub.option("fields", o->fields, "fields.vtkhdf of a run of this scene").required();
  sub.option("-o,--output", o->output, "folder of the pictures; default `frames` beside the fields");
  sub.option("--environment", o->environment, "the fields are those of this one of the scene's `environments`").not_negative();
  sub.option("--frames", *frames, "A:B, A: or A; default all");
  sub.option("--every", o->every, "only every so many frames; default as `render.every` of the scene").positive();
  sub.footer(
      "Examples:\n  mortise render scenes/tactile/press.yaml out/press/fields.vtkhdf\n"
      "  mortise render press.yaml out/press/fields.vtkhdf --frames 40: -o closeup --set render.cameras.beauty.fov=0.2\n"
      "  mortise render pad.yaml out/pad/fields.vtkhdf --every 1 --set 'sensors.map.range=[0, 20 kPa]'");
  sub.action([o, frames, &context] {
    context.action = [o, frames] {
      const FrameRange range = frame_range(*frames);
      o->first = range.first, o->last = range.last;
      return cmd_render(*o);
    };
  });
}

}  // namespace mortise::cli
