// mortise study: accuracy against time.
#include "study/study.h"

#include <fmt/format.h>

#include <filesystem>
#include <iostream>
#include <memory>

#include "cli/commands.h"
#include "engine/choose.h"
#include "output/atomic_file.h"

namespace mortise::cli {
namespace {

struct Options {
  std::string scene, output = "out/study", device = "cpu";
  std::vector<std::string> overrides, vary, quantities;
  std::vector<double> references;
  int threads = 0, repeats = 1;
};

int cmd_study(const Options& o) {
  study::Study study{o.scene, o.overrides, {}, o.quantities, o.references, o.repeats};
  for (const std::string& v : o.vary) study.vary.push_back(study::parse_vary(v));
  engine::choose(o.device, o.threads);
  const auto label = [](const study::Point& p) {
    std::string text = p.method;
    for (const auto& [key, value] : p.settings) text += (text.empty() ? "" : " ") + key + "=" + value;
    return text;
  };
  const std::vector<study::Point> points = study::run_study(
      study,
      [&](const study::Point& p) {
        std::cerr << fmt::format("{:50} {:28} {:>13} error {:>11} {:>9.3g} s\n", label(p), p.quantity,
                                 p.failed ? "failed" : fmt::format("{:.6g}", p.value),
                                 p.reference ? "reference" : (p.failed ? "-" : fmt::format("{:.3g}", p.error)), p.seconds);
      },
      [](const std::string& reference) { std::cerr << reference << "\n"; });
  std::error_code ec;
  std::filesystem::create_directories(o.output, ec);
  if (ec) throw Error(Exit::file, "cannot create '" + o.output + "': " + ec.message());
  output::write_file_atomically(o.output + "/points.csv", study::points_csv(points), false);
  for (std::size_t k = 0; k < o.quantities.size(); ++k) {
    std::string name = o.quantities[k];
    for (char& c : name)
      if (!std::isalnum(static_cast<unsigned char>(c))) c = '_';
    output::write_file_atomically(o.output + "/" + name + ".svg",
                                  study::figure_svg(points, o.quantities[k], std::filesystem::path(o.scene).stem().string()), false);
  }
  std::cout << "on the front (nothing faster is as accurate):\n";
  for (const study::Point& p : points)
    if (p.best) std::cout << fmt::format("  {:28} {:50} error {:.3g} in {:.3g} s\n", p.quantity, label(p), p.error, p.seconds);
  std::cout << "written: " << o.output << "/points.csv and one figure per quantity\n";
  return 0;
}

}  // namespace

void add_study(Command app, Context& context) {
  const Command sub = app.command("study", "run with varied settings and compare accuracy and time");
  auto o = std::make_shared<Options>();
  add_scene_options(sub, o->scene, o->overrides);
  sub.option("--vary", o->vary, "key=v1,v2,...: the first one varied is the ladder, combinations of the others are curves").required().take_all();
  sub.option("--qoi", o->quantities, "quantity to compare: group/name of any scalar at the last step (sensors' too), or a quantity of a benchmark")
      .required()
      .take_all();
  sub.option("--reference", o->references,
             "its right value, one per --qoi; default: the limit of the ladder on the first curve (Richardson, order observed), or its last "
             "value where it has none; printed");
  sub.option("-o,--output", o->output, "folder for points.csv and figures").show_default();
  sub.option("--repeat", o->repeats, "runs of every setting; the fastest counts");
  add_device_options(sub, o->device, o->threads);
  sub.footer(
      "Examples:\n  mortise study scene.yaml --vary time.step='10 ms,5 ms,2.5 ms' --qoi elasticity/energy -o out/steps      (all runs end at the "
      "same time)\n"
      "  mortise study hertz --vary size=coarse,medium --qoi 'pressure L2, r <= a'      (a benchmark: one curve per method)");
  sub.action([o, &context] { context.action = [o] { return cmd_study(*o); }; });
}

}  // namespace mortise::cli
