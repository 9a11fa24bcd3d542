#include "run/results.h"

#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <cmath>

#include "base/memory_archive.h"
#include "base/version.h"
#include "output/atomic_file.h"
#include "run/output_mesh.h"
#include "run/sensor_facts.h"
#include "run/step_row.h"
#include "run/stopwatch.h"
#include "run/tuning.h"

namespace mortise::run {

namespace {

output::FieldOptions field_options(const Params& out, long in_turn) {
  output::FieldOptions fields;
  fields.double_precision = out.text("precision") == "double";
  if (const Params* names = out.find("fields"))
    for (const Params& name : names->items()) fields.fields.push_back(name.as_text());
  // A checkpoint commits the frames that it speaks of. Others may be lost in a kill, as --resume computes them again.
  fields.commit_seconds = std::max(1.0, tuning::kCommitting * static_cast<double>(in_turn));
  return fields;
}

}  // namespace

Results::Results(const Options& options, const Params& scene, std::string hash, const model::ModelInput& input, const Folder& folder,
                 const sensors::Sensors& sensors, Record& record)
    : options_(options),
      scene_(scene),
      hash_(std::move(hash)),
      folder_(folder),
      sensors_(sensors),
      record_(record),
      fields_(field_options(scene.at("output"), options.in_turn)),
      newton_log_(folder.file("newton.csv")),
      certificate_(input),
      checks_(input) {
  const Params* render = scene.find("render");
  if (render) picture_every_ = render->integer("every");
  if (options.no_render || !scene.at("output").flag("pictures")) return;
  if (render && render->has("cameras")) pictures_ = std::make_unique<Pictures>(scene, input, folder.file("frames"));
  if (!sensors.empty()) sensor_maps_.emplace(scene, sensors, folder.file("frames"));
}

void Results::begin(const model::ModelInput& input, const std::string& resolved) {
  file_ = output::FieldFile::open(folder_.file("fields.vtkhdf"), output_mesh(input), info(resolved), fields_);
}

output::FileInfo Results::info(const std::string& resolved) const { return {version(), git_sha1(), resolved, hash_}; }

void Results::go_on(output::CheckpointReader& from, const std::string& resolved) {
  whole_ = false;
  checkpoint(from);
  const output::FileInfo now = info(resolved);
  file_ = output::FieldFile::reopen(folder_.file("fields.vtkhdf"), from.info().frames, from.info().step, fields_,
                                    from.info().scene_sha256 != hash_ ? &now : nullptr);
  record_.steps = file_->steps();
  // They are of a run that ended; this one has not.
  for (const char* end : {"certificate.json", "run.json"}) ::unlink(folder_.file(end).c_str());
}

void Results::state(const State& now) {
  if (now.frame) {
    frame(now);
  } else {
    certificate_.state(now.said, now.time);
    checks_.state(now.said, now.points, now.time);
    line(now);
  }
  if (!now.step) return;
  certificate_.step(*now.step);
  checks_.step(*now.step);
}

void Results::frame(const State& now) {
  const Stopwatch output;
  const std::vector<sensors::Reading> readings = sensors_.read(now.said, now.points);
  sensor_reach_.see(readings);
  certificate_.state(now.said, now.time);
  file_->begin_frame(now.time, now.points);
  now.said.report(*file_);
  if (file_->frames() == 0) write_sensor_facts(scene_, sensors_, *file_);
  audit(checks_.state(now.said, now.points, now.time));
  if (now.step) line(now);
  file_->end_frame();
  record_.spent("output", output);
  const Stopwatch pictures;
  const long frame = file_->frames() - 1;
  const bool drawn = frame % picture_every_ == 0;
  if (pictures_ && drawn) pictures_->draw(frame, now.time, now.points, now.said.drawable());
  if (sensor_maps_) sensor_maps_->see(readings);
  if (sensor_maps_ && drawn) sensor_maps_->draw(frame, now.time, readings);
  record_.spent("pictures", pictures);
}

void Results::line(const State& now) {
  contact_ = audit::contact_figures(now.said);
  const output::StepRow row = step_row(*now.step, contact_);
  file_->append_step(row);
  record_.steps.push_back(row);
}

// Energies of the frame's state beside what effects report.
void Results::audit(const audit::EnergyAudit::Result& energy) {
  file_->scalar("audit", "total_energy", "J", energy.total);
  if (!energy.work_is_known) return;
  file_->scalar("audit", "support_work", "J", energy.support_work);
  file_->scalar("audit", "largest_energy_gain", "J", std::isnan(energy.largest_gain) ? 0 : energy.largest_gain);
}

void Results::checkpoint(Archive& archive) {
  PrefixedArchive certificate(archive, "run/certificate"), checks(archive, "run/checks"), log(archive, "run/newton_log"),
      maps(archive, "run/sensor_maps");
  certificate_.checkpoint(certificate);
  checks_.checkpoint(checks);
  newton_log_.checkpoint(log);
  bool drawn = sensor_maps_.has_value();
  maps.io("drawn", drawn);
  if (drawn && sensor_maps_) sensor_maps_->checkpoint(maps);
}

// Checks that begin later than the run ended (by --frames, a partner, a signal or a failure), or that are of an end it was cut off from, are not
// reached: they say nothing of it. Of a good run they are told to `note`.
std::vector<audit::Checks::Verdict> Results::verdicts(const End& end, const std::function<void(const std::string&)>& note) const {
  std::vector<audit::Checks::Verdict> all = checks_.verdicts(end.status, end.message);
  const double until = record_.steps.empty() ? 0 : record_.steps.back().time;
  for (std::size_t i = 0; i < all.size(); ++i) {
    const Params &check = scene_.at("checks").items()[i], *from = check.find("from"), *to = check.find("until"), *when = check.find("when");
    const bool begun = !from || until > from->as_number() + 1e-9;
    const bool cut =
        (options_.frames >= 0 || end.status != Exit::done) && static_cast<long>(record_.steps.size()) < scene_.at("time").integer("steps");
    const bool ended = !cut || !when || when->as_text() != "end" || (to && until > to->as_number() - 1e-9);
    all[i].reached = (begun || std::isfinite(all[i].value)) && ended;
    if (end.status == Exit::done && !all[i].reached) note(fmt::format("check not reached: {}; the run ended at {:.6g} s", all[i].text, until));
  }
  return all;
}

void Results::finish(End& end, const std::function<void(const std::string&)>& note, const std::function<void(const std::string&)>& tell) {
  const std::vector<audit::Checks::Verdict> verdicts = this->verdicts(end, note);
  const auto failed = std::count_if(verdicts.begin(), verdicts.end(), [](const audit::Checks::Verdict& v) { return v.reached && !v.pass; });
  if (end.status == Exit::done && failed > 0) end.status = Exit::checks, end.message = fmt::format("{} of {} checks failed", failed, verdicts.size());
  const std::string name = scene_.text("name");
  auto [grade, certificate] = certificate_.write({name, hash_, record_.device.kind, end.status, end.message, checks_.energy(), end.estimated.worst});
  end.grade = std::move(grade);
  if (!end.estimated.json.empty()) certificate = audit::with_error_budget(certificate, end.estimated.json);
  output::write_file_atomically(folder_.file("certificate.json"), audit::Checks::add_to(certificate, verdicts), true);
  for (const audit::Checks::Verdict& v : verdicts)
    if (v.reached && !v.pass) tell(fmt::format("check failed: {}; it is {}", v.text, v.found.empty() ? fmt::format("{:.6g}", v.value) : v.found));
  if (file_ && file_->can_flush()) file_->flush();
  if (end.status == Exit::done && certificate_.nothing_touched()) note("warning: nothing touched at any time, so that contact had nothing to do");
  if (whole_ && (end.status == Exit::done || end.status == Exit::checks))
    for (const std::string& warning : sensor_reach_.warnings(sensors_)) note("warning: " + warning);
  record_.frames = frames();
  record_.write(folder_.file("run.json"), {options_, name, hash_, end.status, end.message, end.wall}, end.engine);
}

}  // namespace mortise::run
