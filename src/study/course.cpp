#include "study/course.h"

#include <filesystem>

#include "audit/contact_figures.h"
#include "base/cpu_time.h"
#include "base/version.h"
#include "run/output_mesh.h"
#include "run/signals.h"
#include "run/step_row.h"
#include "study/measure.h"

namespace mortise::study {

void check(const engine::Outcome& outcome) {
  if (outcome.code != 0) throw Error(static_cast<Exit>(outcome.code), outcome.message, outcome.located);
}

Course::Course(const scene::Scene& scene, const std::string& file, const engine::Choice& choice)
    : Course(scene, engine::make_input(scene.root), file, choice) {}

Course::Course(const Course& other, const std::string& file, const engine::Choice& choice) : Course(other.scene_, other.input_, file, choice) {}

Course::Course(const scene::Scene& scene, const model::ModelInput& input, const std::string& file, const engine::Choice& choice)
    : scene_(scene), input_(input), file_(file), sensors_(input_), audit_(input_) {
  check(choice.api->create(input_, engine_));
}

Course::~Course() {
  out_.reset();
  std::error_code ec;
  std::filesystem::remove(file_, ec);
}

void Course::open() {
  output::FieldOptions options;
  options.double_precision = true, options.xdmf = false, options.commit_seconds = 1e9;
  out_ = output::FieldFile::open(file_, run::output_mesh(input_), {version(), git_sha1(), "", ""}, options);
  see(nullptr, true);
}

void Course::see(const solver::StepReport* report, bool frame) {
  state_ = {};
  engine_->report(state_);
  points_ = engine_->points();
  sensors_.read(state_, points_);
  const audit::EnergyAudit::Result energy = audit_.state({state_, points_});
  if (report) out_->append_step(run::step_row(*report, audit::contact_figures(state_)));
  if (!frame) return;
  out_->begin_frame(engine_->time(), points_);
  state_.report(*out_);
  out_->scalar("audit", "total_energy", "J", energy.total);
  if (energy.work_is_known) out_->scalar("audit", "support_work", "J", energy.support_work);
  out_->end_frame();
}

std::vector<double> Course::measure(const std::vector<Quantity>& quantities) {
  if (out_) out_->close();
  out_.reset();
  const output::FieldReader reader(file_);
  std::vector<double> values;
  for (const Quantity& q : quantities) values.push_back(study::measure(reader, q));
  return values;
}

std::vector<double> Course::missed_between(const std::vector<Quantity>& quantities) const {
  const output::FieldReader reader(file_);
  const auto missed = input().scene.at("time").text("mode") == "static" ? study::turned_between : study::missed_between;
  std::vector<double> out;
  for (const Quantity& q : quantities) out.push_back(missed(reader, q));
  return out;
}

std::vector<double> Course::largest_apart(const Course& other, const std::vector<Quantity>& quantities) const {
  const output::FieldReader reader(file_), beside(other.file_);
  std::vector<double> out;
  for (const Quantity& q : quantities) out.push_back(study::largest_apart(reader, beside, q));
  return out;
}

double take(Course& first, const std::vector<Course*>& beside, const std::function<void(const Snapshot&)>& see) {
  std::vector<engine::Engine*> led;
  for (Course* course : beside) led.push_back(&course->engine());
  check(first.engine().lead(led));
  first.open();
  for (Course* course : beside) course->open();
  const Params& time = first.input().scene.at("time");
  const long steps = time.integer("steps"), every = time.integer("frame_every");
  double seconds = 0;
  for (long step = 1; step <= steps; ++step) {
    const double start = cpu_time();
    solver::StepReport report;
    check(first.engine().step(run::stop_asked, report));
    seconds += cpu_time() - start;
    const bool frame = step % every == 0 || step == steps;
    first.see(&report, frame);
    if (see) see(first.state());
    for (Course* course : beside)
      if (course->engine().lost().empty()) course->see(nullptr, frame);
  }
  return seconds;
}

}  // namespace mortise::study
