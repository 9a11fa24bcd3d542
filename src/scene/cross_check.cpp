#include "scene/cross_check.h"

#include <algorithm>
#include <map>

#include "scene/checker.h"
#include "scene/checks.h"
#include "scene/edge_lengths.h"
#include "scene/field_units.h"
#include "scene/pass_through.h"
#include "scene/quantities.h"
#include "scene/quantity.h"
#include "scene/sensors.h"
#include "scene/suggest.h"

namespace mortise::scene {
namespace {

class CrossCheck {
 public:
  CrossCheck(const Params& root, std::span<const EffectTable> tables, const std::set<std::string>& incomplete, Diagnostics& errors)
      : root_(root), tables_(tables), incomplete_(incomplete), errors_(errors), bodies_(root.find("bodies")), effects_(root.find("effects")) {}

  void run() {
    if (const Params* name = root_.find("name"); name && !is_name(name->as_text()))
      errors_.add(name->where(), "'" + name->as_text() + "' is not a name; names are made of a-z, 0-9, _ and -");
    mode();
    if (bodies_) {
      if (bodies_->entries().empty()) errors_.add(bodies_->where(), "the scene has no body");
      for (const auto& [name, body] : bodies_->entries()) this->body(name, body);
    }
    if (effects_)
      for (const auto& [name, effect] : effects_->entries()) references(name, effect, dotted("effects", name));
    pairs();
    contact_pairs();
    ties();
    cameras();
    kept_fields();
    measured_fields();
    directions(root_, "");
  }

 private:
  bool has_effect(const char* name) const { return effects_ && effects_->has(name); }
  // The block of the first effect that makes a scene dynamic; null without one.
  const Params* inertia() const {
    for (const EffectTable& t : tables_)
      if (t.inertia && has_effect(t.name.c_str())) return &effects_->at(t.name);
    return nullptr;
  }
  // Whether an effect that is not found is really not there.
  bool effects_known() const { return effects_ && !incomplete_.count("effects"); }

  void mode() {
    const Params* time = root_.find("time");
    const Params* mode = time ? time->find("mode") : nullptr;
    if (!mode) return;
    const bool is_static = mode->as_text() == "static";
    if (is_static && time->has("step"))
      errors_.add(time->at("step").where(), "time.step has no meaning in a static scene", "time.steps load steps divide pseudo-time 0..1 evenly",
                  {{mode->where(), "static here"}});
    if (!is_static && !time->has("step") && !incomplete_.count("time"))
      errors_.add(time->where(), "time has no 'step'", "[s] Time step; a dynamic scene needs it.");
    if (is_static && inertia())
      errors_.add(inertia()->where(), "a static scene has no inertia", "remove it, or make the scene dynamic", {{mode->where(), "static here"}});
    if (!is_static && effects_known() && !inertia())
      errors_.add(effects_->where(), "a dynamic scene needs the effect 'inertia'", "add 'inertia: {}', or set time.mode: static");
  }

  void body(const std::string& name, const Params& body) {
    const std::string path = "bodies." + name;
    const Params* type = body.find("type");
    if (!type || type->as_text() == "half_space") return;
    const bool soft = type->as_text() == "soft";
    if (const Params* shape = body.find("shape"); shape && !soft) stiff_mesh(*shape, path + ".shape", *type);
    if (const Params* shape = body.find("shape"); shape && soft && shape->has("parts"))
      errors_.add(shape->at("parts").where(), path + ".shape.parts are for stiff bodies: a soft body is of one piece", "",
                  {{type->where(), "soft here"}});
    if (!soft && body.has("inertia") && !body.has("mass") && !incomplete_.count(path))
      errors_.add(body.at("inertia").where(), path + ".inertia needs the body's 'mass'");
    if (!soft && !body.has("material") && !body.has("mass") && !incomplete_.count(path))
      errors_.add(body.where(), path + " has neither 'material' nor 'mass'");

    const Params* materials = root_.find("materials");
    const Params* material = body.find("material");
    if (material && materials && !(incomplete_.count("") && materials->entries().empty()) &&
        exists(*materials, material->as_text(), "material", *material, path + ".material"))
      elastic_constants(soft, *materials, *material);

    if (effects_known() && soft && !has_effect("elasticity"))
      errors_.add(body.where(), "soft body '" + name + "' needs the effect 'elasticity'", "add 'elasticity: {}' under effects",
                  {{effects_->where(), "the effects"}});
    if (effects_known() && !soft && !has_effect("affine_body") && !fully_pinned(name))
      errors_.add(body.where(), "stiff body '" + name + "' needs the effect 'affine_body'",
                  "add it under effects, or pin all of the body (where: {side: all})", {{effects_->where(), "the effects"}});
  }

  void stiff_mesh(const Params& shape, const std::string& path, const Params& type) {
    if (const Params* parts = shape.find("parts"))
      for (std::size_t i = 0; i < parts->items().size(); ++i)
        if (const Params* part = parts->items()[i].find("shape")) stiff_mesh(*part, path + ".parts." + std::to_string(i) + ".shape", type);
    const Params* mesh = shape.find("mesh");
    if (!mesh) return;
    for (const char* key : kEdgeLengths)
      if (mesh->has(key))
        errors_.add(mesh->at(key).where(), path + ".mesh." + key + " has no meaning: the surface of a stiff body is taken as its file has it",
                    "remove it, or make the body soft", {{type.where(), "stiff here"}});
  }

  void elastic_constants(bool soft, const Params& materials, const Params& name) {
    const Params& material = materials.at(name.as_text());
    if (!soft || incomplete_.count("materials." + name.as_text())) return;
    for (const char* key : {"youngs_modulus", "poisson_ratio"})
      if (!material.has(key))
        errors_.add(material.where(), "materials." + name.as_text() + " has no '" + key + "', which soft bodies need", "",
                    {{name.where(), "used by a soft body here"}});
  }

  bool fully_pinned(const std::string& body) const {
    const Params* pins = effects_->find("pin");
    if (!pins || pins->kind() != Params::Kind::list) return false;
    return std::any_of(pins->items().begin(), pins->items().end(), [&](const Params& pin) {
      const Params* name = pin.find("body");
      const Params* where = pin.find("where");
      const Params* side = where ? where->find("side") : nullptr;
      const Params* axes = pin.find("axes");
      const bool meant = name && bodies_ && !bodies_->has(name->as_text());  // told by itself; it may be this one
      return name && (meant || name->as_text() == body) && side && side->as_text() == "all" && (!axes || axes->as_text().size() == 3);
    });
  }

  // Whether the named block exists; an error if not.
  bool exists(const Params& blocks, const std::string& wanted, const std::string& what, const Params& cited, const std::string& path) {
    if (blocks.has(wanted)) return true;
    std::vector<std::string> names;
    for (const auto& [name, block] : blocks.entries()) names.push_back(name);
    const std::string hint =
        wanted == "world" && path.ends_with(".to") ? "the world has no name: a joint is to it where 'to' is left out" : suggestion(wanted, names);
    errors_.add(cited.where(), path + ": no " + what + " '" + wanted + "'", names.empty() ? "the scene has none" : hint);
    return false;
  }

  // Everything under an effect that names a body or another effect.
  void references(const std::string& effect, const Params& p, const std::string& path) {
    if (p.kind() == Params::Kind::list) {
      for (std::size_t i = 0; i < p.items().size(); ++i) references(effect, p.items()[i], dotted(path, std::to_string(i)));
    } else if (p.kind() == Params::Kind::table) {
      for (const auto& [key, value] : p.entries()) {
        if (names_body(key) && !is_list_of_tables(value))
          bodies_in(value, dotted(path, key));
        else if (key == "follows" && value.kind() == Params::Kind::text)
          follows(effect, value, dotted(path, key));
        else
          references(effect, value, dotted(path, key));
      }
    }
  }
  static bool names_body(const std::string& key) {
    static const std::set<std::string> keys{"body", "bodies", "pairs", "slave", "master", "a", "b", "to"};
    return keys.count(key) > 0;
  }
  static bool is_list_of_tables(const Params& p) {
    return p.kind() == Params::Kind::list && !p.items().empty() && p.items()[0].kind() == Params::Kind::table;
  }
  void bodies_in(const Params& p, const std::string& path) {
    if (!bodies_ || incomplete_.count("bodies")) return;
    if (p.kind() == Params::Kind::text) exists(*bodies_, p.as_text(), "body", p, path);
    if (p.kind() == Params::Kind::list)
      for (std::size_t i = 0; i < p.items().size(); ++i) bodies_in(p.items()[i], dotted(path, std::to_string(i)));
  }
  void follows(const std::string& effect, const Params& p, const std::string& path) {
    if (!effects_known()) return;
    std::vector<std::string> others;
    for (const auto& [name, block] : effects_->entries())
      if (name != effect) others.push_back(name);
    if (std::find(others.begin(), others.end(), p.as_text()) != others.end()) return;
    const std::string best = nearest(p.as_text(), others);
    errors_.add(p.where(), path + " is '" + p.as_text() + "', which this scene does not list", best.empty() ? "" : "did you mean '" + best + "'?",
                {{effects_->where(), "the effects: " + join(others, ", ")}});
  }

  // Those that a contact effect is asked to look at.
  void contact_pairs() {
    for (const EffectTable& table : tables_) {
      const Params* list = table.contact && has_effect(table.name.c_str()) ? effects_->at(table.name).find("pairs") : nullptr;
      if (!list || list->kind() != Params::Kind::list) continue;
      for (std::size_t i = 0; i < list->items().size(); ++i) {
        const Params& pair = list->items()[i];
        if (pair.kind() != Params::Kind::list || pair.items().size() != 2 || pair.items()[0].as_text() != pair.items()[1].as_text()) continue;
        errors_.add(pair.where(), "effects." + table.name + ".pairs." + std::to_string(i) + " names '" + pair.items()[0].as_text() + "' twice",
                    "soft bodies meet themselves without that");
      }
    }
  }

  // Pairs that differ from the others: no pair twice, and none that an effect is asked to press together.
  void pairs() {
    const Params* list = root_.find("pairs");
    if (!list || list->kind() != Params::Kind::list) return;
    std::map<std::set<std::string>, SourceLoc> seen;
    for (std::size_t i = 0; i < list->items().size(); ++i) {
      const Params& entry = list->items()[i];
      const Params *bodies = entry.find("bodies"), *collide = entry.find("collide");
      if (!bodies || !collide) continue;
      const std::string path = "pairs." + std::to_string(i) + ".bodies";
      if (bodies->items().size() < 2)
        errors_.add(bodies->where(), path + " has " + (bodies->items().empty() ? "no name" : "one name") + " where a pair has two");
      bodies_in(*bodies, path);
      for (std::size_t a = 0; a < bodies->items().size(); ++a)
        for (std::size_t b = a + 1; b < bodies->items().size(); ++b) pair(entry, bodies->items()[a], bodies->items()[b], collide->as_flag(), seen);
    }
  }
  void pair(const Params& entry, const Params& first, const Params& second, bool collide, std::map<std::set<std::string>, SourceLoc>& seen) {
    const std::string &a = first.as_text(), &b = second.as_text();
    if (a == b) return errors_.add(second.where(), "'" + a + "' is named twice", "whether a soft body meets itself is said by its own self_contact");
    const auto [at, fresh] = seen.emplace(std::set<std::string>{a, b}, entry.where());
    if (!fresh) errors_.add(entry.where(), "the pair of '" + a + "' and '" + b + "' is listed twice", "", {{at->second, "first here"}});
    if (collide || !effects_) return;
    for (const auto& [name, effect] : effects_->entries())
      if (const Params* asked = effect.kind() == Params::Kind::table ? listed_pair(effect, a, b) : nullptr)
        errors_.add(entry.where(), "'" + a + "' and '" + b + "' shall not collide, but " + name + " lists them as a pair", "remove one of the two",
                    {{asked->where(), "listed here"}});
  }

  // Ties are called by names of their own, and an effect that lists their bodies as a pair shall not be overruled in silence.
  void ties() {
    if (!effects_) return;
    for (const EffectTable& table : tables_) {
      const Params* list = table.ties ? effects_->find(table.name) : nullptr;
      if (!list || list->kind() != Params::Kind::list) continue;
      std::map<std::string, SourceLoc> names;
      for (const Params& tie : list->items()) {
        if (const Params* own = tie.find("name"))
          if (const auto [at, fresh] = names.emplace(own->as_text(), own->where()); !fresh)
            errors_.add(own->where(), "two entries of " + table.name + " are called '" + own->as_text() + "'", "", {{at->second, "the first one"}});
        const Params *name = tie.find("name"), *body = tie.find("body"), *to = tie.find("to"), *contact = tie.find("contact");
        if (name && !is_name(name->as_text()))
          errors_.add(name->where(), "'" + name->as_text() + "' is not a name; names are made of a-z, 0-9, _ and -");
        if (!body || !to || !contact || contact->as_flag()) continue;
        for (const auto& [effect, params] : effects_->entries())
          if (const Params* asked = params.kind() == Params::Kind::table ? listed_pair(params, body->as_text(), to->as_text()) : nullptr)
            errors_.add(asked->where(),
                        effect + " lists '" + body->as_text() + "' and '" + to->as_text() + "' as a pair, but a " + table.name +
                            " ties them, and without contact",
                        "remove the pair, or give the " + table.name + " 'contact: true'", {{tie.where(), "tied here"}});
      }
    }
  }

  static bool writes(const Params& camera, const std::string& kind) {
    const Params* outputs = camera.find("outputs");
    if (!outputs) return kind == "color";
    return std::any_of(outputs->items().begin(), outputs->items().end(), [&](const Params& o) { return o.as_text() == kind; });
  }

  // A scale of colours is in a unit of what it shows.
  void colour_scale(const Params& camera, const std::string& path) {
    const Params *by = camera.find("colour_by"), *unit = camera.find("unit");
    if (!by && !incomplete_.count(path))
      for (const char* key : {"unit", "range"})
        if (const Params* useless = camera.find(key))
          errors_.add(useless->where(), path + "." + key + " is of no use: the camera colours by no field", "colour_by: contact_pressure");
    if (!by || !unit) return;
    if (const std::string wrong = wrong_unit(by->as_text(), unit->as_text()); !wrong.empty()) {
      const std::vector<std::string> known = units_of_field(by->as_text());
      const std::string near = nearest(unit->as_text(), known);
      errors_.add(unit->where(), path + ".unit " + wrong,
                  near.empty() ? "units of " + by->as_text() + ": " + join(known, ", ") : "did you mean '" + near + "'?");
    }
  }

  void cameras() {
    const Params* render = root_.find("render");
    const Params* cameras = render ? render->find("cameras") : nullptr;
    if (!cameras) return;
    for (const auto& [name, camera] : cameras->entries()) {
      const std::string path = "render.cameras." + name;
      const Params *from = camera.find("position"), *to = camera.find("look_at"), *range = camera.find("range");
      const Params* up = camera.find("up");
      if (from && to && from->as_vec3() == to->as_vec3())
        errors_.add(to->where(), path + ".look_at is where the camera stands");
      else if (const Vec3 sight = from && to ? Vec3(to->as_vec3() - from->as_vec3()) : Vec3::Zero();
               up && up->where().text() != camera.where().text() && !sight.isZero(0) &&
               !(sight.cross(up->as_vec3()).norm() > 1e-9 * sight.norm() * up->as_vec3().norm()))
        errors_.add(up->where(), path + ".up is along the line of sight", "it points to the upper edge of the picture, as [0, 0, 1] does for most");
      const Params *model = camera.find("model"), *fov = camera.find("fov"), *hide = camera.find("hide");
      if (fov && model && model->as_text() == "pinhole" && fov->as_number() > 3.1)
        errors_.add(fov->where(), path + ".fov must be below 180 deg for a pinhole camera", "model: fisheye has no such limit");
      if (hide) bodies_in(*hide, path + ".hide");
      if (const Params* carrier = camera.find("rides_on")) {
        bodies_in(*carrier, path + ".rides_on");
        const Params *body = bodies_ ? bodies_->find(carrier->as_text()) : nullptr, *type = body ? body->find("type") : nullptr;
        if (type && type->as_text() == "half_space")
          errors_.add(carrier->where(), path + ".rides_on: '" + carrier->as_text() + "' is a half_space, which never moves");
      }
      for (const auto& [other, unused] : cameras->entries())
        for (const char* kind : {"depth", "segmentation"})
          if (other == name + "_" + kind && writes(camera, kind))
            errors_.add(camera.at("outputs").where(),
                        path + ": its " + kind + " images would have the names of the pictures of camera '" + other + "'", "rename one of them");
      if (const Params* unit = camera.find("depth_unit"); unit && !writes(camera, "depth"))
        errors_.add(unit->where(), path + ".depth_unit is of no use: the camera writes no depth", "outputs: [color, depth]");
      if (const Params* traction = camera.find("traction")) {
        const std::vector<std::string> known = fields(false);
        const auto& asked = traction->at("of").items();
        if (effects_known() &&
            std::none_of(asked.begin(), asked.end(), [&](const Params& f) { return std::count(known.begin(), known.end(), f.as_text()); }))
          errors_.add(traction->where(), path + ".traction: no effect of the scene reports any of its forces",
                      "fields of points here: " + join(known, ", "));
      }
      if (const Params* by = camera.find("colour_by")) is_field(*by, path + ".colour_by", fields(false));
      colour_scale(camera, path);
      if (range && (range->items().size() != 2 || !(range->items()[0].as_number() < range->items()[1].as_number())))
        errors_.add(range->where(), path + ".range must be two increasing numbers");
    }
  }

  // What the scene's effects report.
  std::vector<std::string> fields(bool of_cells_too) const {
    std::vector<std::string> out{"displacement"};
    for (const EffectTable& table : tables_) {
      if (!has_effect(table.name.c_str())) continue;
      out.insert(out.end(), table.point_fields.begin(), table.point_fields.end());
      if (of_cells_too) out.insert(out.end(), table.cell_fields.begin(), table.cell_fields.end());
    }
    std::sort(out.begin(), out.end());
    out.erase(std::unique(out.begin(), out.end()), out.end());
    return out;
  }
  void is_field(const Params& name, const std::string& path, const std::vector<std::string>& known) {
    if (!effects_known() || std::find(known.begin(), known.end(), name.as_text()) != known.end()) return;
    errors_.add(name.where(), path + ": no effect of this scene reports a field '" + name.as_text() + "'", suggestion(name.as_text(), known));
  }
  const Params* fields_to_keep() const {
    const Params* output = root_.find("output");
    return output ? output->find("fields") : nullptr;
  }
  void kept_fields() {
    const Params* names = fields_to_keep();
    if (!names) return;
    if (names->items().empty()) errors_.add(names->where(), "output.fields names nothing", "leave it out to keep all");
    for (const Params& name : names->items()) is_field(name, "output.fields", fields(true));
  }

  // Of quantities; what scalars there are the run alone knows, and it says so at its end.
  void measured_fields() {
    const Params* list = root_.find("quantities");
    if (!list) return;
    std::vector<std::string> known = fields(false);
    known.emplace_back("position");
    for (std::size_t i = 0; i < list->items().size(); ++i) {
      const Params *value = list->items()[i].find("value"), *body = list->items()[i].find("body");
      if (!value || !body || value->as_text().find('/') != std::string::npos) continue;
      const std::string path = dotted("quantities", std::to_string(i)) + ".value";
      is_field(*value, path, known);
      const Params* names = fields_to_keep();
      const auto is_it = [&](const Params& name) { return name.as_text() == value->as_text(); };
      if (names && value->as_text() != "position" && std::none_of(names->items().begin(), names->items().end(), is_it))
        errors_.add(value->where(), path + ": '" + value->as_text() + "' is not kept", "add it to output.fields",
                    {{names->where(), "the fields that are"}});
    }
  }

  // Directions have no length of their own, but zero has no direction.
  void directions(const Params& p, const std::string& path) {
    if (p.kind() == Params::Kind::list)
      for (std::size_t i = 0; i < p.items().size(); ++i) directions(p.items()[i], dotted(path, std::to_string(i)));
    if (p.kind() != Params::Kind::table) return;
    for (const auto& [key, value] : p.entries()) {
      const bool direction = (key == "axis" || key == "normal" || key == "up") && value.kind() == Params::Kind::list && value.items().size() == 3;
      if (direction && value.items()[0].kind() != Params::Kind::list && value.as_vec3().isZero(0))
        errors_.add(value.where(), dotted(path, key) + " is zero; a direction is wanted");
      directions(value, dotted(path, key));
    }
  }

  const Params& root_;
  std::span<const EffectTable> tables_;
  const std::set<std::string>& incomplete_;
  Diagnostics& errors_;
  const Params *bodies_, *effects_;
};

}  // namespace

void cross_check(const Params& root, std::span<const EffectTable> effects, const std::set<std::string>& incomplete, Diagnostics& errors) {
  CrossCheck(root, effects, incomplete, errors).run();
  check_checks(root, effects, incomplete, errors);
  check_sensors(root, effects, incomplete, errors);
  check_quantities(root, incomplete, errors);
}

}  // namespace mortise::scene
