#include "study/recording.h"

#include <filesystem>

#include "base/version.h"
#include "output/field_reader.h"
#include "run/contact_figures.h"
#include "run/output_mesh.h"
#include "run/step_row.h"
#include "study/measure.h"

namespace mortise::study {

void check(const engine::Outcome& outcome) {
  if (outcome.code != 0) throw Error(static_cast<Exit>(outcome.code), outcome.message, outcome.located);
}

Recording::Recording(engine::Engine& engine, const model::ModelInput& input, std::string file)
    : engine_(engine), input_(input), file_(std::move(file)), sensors_(input), audit_(input) {}

Recording::~Recording() {
  out_.reset();
  reader_.reset();
  std::error_code ec;
  std::filesystem::remove(file_, ec);
}

void Recording::open() {
  output::FieldOptions options;
  options.double_precision = true, options.xdmf = false, options.commit_seconds = 1e9;
  out_ = output::FieldFile::open(file_, run::output_mesh(input_), {version(), git_sha1(), "", ""}, options);
  see(nullptr, true);
}

void Recording::see(const solver::StepReport* report, bool frame) {
  Snapshot state;
  engine_.report(state);
  const std::vector<double> points = engine_.points();
  sensors_.read(state, points);
  const run::EnergyAudit::Result energy = audit_.state({state, points});
  if (report) out_->append_step(run::step_row(*report, run::contact_figures(state)));
  if (!frame) return;
  out_->begin_frame(engine_.time(), points);
  state.report(*out_);
  out_->scalar("audit", "total_energy", "J", energy.total);
  if (energy.work_is_known) out_->scalar("audit", "support_work", "J", energy.support_work);
  out_->end_frame();
}

const output::FieldReader& Recording::read() {
  if (out_) out_->close();
  out_.reset();
  if (!reader_) reader_ = std::make_unique<output::FieldReader>(file_);
  return *reader_;
}

std::vector<double> Recording::measure(const std::vector<Quantity>& quantities) {
  std::vector<double> values;
  for (const Quantity& q : quantities) values.push_back(study::measure(read(), q));
  return values;
}

}  // namespace mortise::study
