#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <filesystem>
#include <iostream>

#include "base/error.h"
#include "cli/commands.h"
#include "cli/terminal.h"
#include "engine/choose.h"
#include "geometry/tetrahedralise.h"
#include "importers/robot_block.h"
#include "output/column_file.h"
#include "scene/robot.h"
#include "scene/suggest.h"
#include "scene/trajectory.h"

namespace mortise::cli {
namespace {

// The one list of subcommands, in the order of the help text.
using Add = void (*)(Command, Context&);
constexpr Add kCommands[] = {add_run,    add_render, add_bench, add_study,   add_sweep,  add_merge,
                             add_import, add_export, add_check, add_effects, add_schema, add_info};

constexpr const char* kExamples =
    "Examples:\n"
    "  mortise scenes/first/02_block_on_floor.yaml -o out/block    run a scene\n"
    "  mortise check scene.yaml --set time.steps=10                find every error in a scene\n"
    "  mortise effects barrier_contact                             what an effect does, its keys and units\n"
    "\n"
    "Exit codes: 0 done, 1 internal error, 2 usage, 3 scene invalid, 4 device, 5 solve failed, 6 file, 7 checks failed,\n            8 a bridge's "
    "partner "
    "failed, 75 stopped (run --resume), 141 standard output closed";

std::vector<std::string> command_names(const CLI::App& app) {
  std::vector<std::string> out;
  for (const CLI::App* sub : app.get_subcommands([](const CLI::App*) { return true; })) out.push_back(sub->get_name());
  return out;
}

// --color stands anywhere and belongs to no command.
void take_colour(std::vector<std::string>& args) {
  for (std::size_t i = 0; i < args.size() && args[i] != "--"; ++i) {
    std::string value;
    std::size_t used = 1;
    if (args[i].rfind("--color=", 0) == 0)
      value = args[i].substr(8);
    else if (args[i] == "--color" && i + 1 < args.size())
      value = args[i + 1], used = 2;
    else
      continue;
    if (value != "auto" && value != "always" && value != "never")
      throw Error(Exit::usage, "--color is '" + value + "'; must be auto, always or never");
    set_colour(value == "always" ? Colour::always : value == "never" ? Colour::never : Colour::automatic);
    args.erase(args.begin() + i, args.begin() + i + used);
    --i;
  }
}

// `mortise help run` is `mortise run --help`.
void turn_help(std::vector<std::string>& args) {
  if (args.empty() || args[0] != "help") return;
  args.erase(args.begin());
  args.resize(std::min<std::size_t>(args.size(), 1));
  args.push_back("--help");
}

// `mortise scene.yaml` is `mortise run scene.yaml`.
void insert_run(std::vector<std::string>& args, const std::vector<std::string>& commands) {
  static const std::vector<std::string> global{"-h", "--help", "--version"};
  if (args.empty() || std::count(commands.begin(), commands.end(), args[0]) || std::count(global.begin(), global.end(), args[0])) return;
  const std::string& first = args[0];
  std::error_code ignored;
  const bool scene =
      first == "-" || first.find('/') != std::string::npos || first.find(".y") != std::string::npos || std::filesystem::exists(first, ignored);
  const bool flag = first.size() > 1 && first[0] == '-';
  // A flag in front: its command can only be run, if there is a scene at all.
  const bool scene_follows =
      flag && std::any_of(args.begin(), args.end(), [](const std::string& a) { return a == "-" || a.find(".y") != std::string::npos; });
  if (scene || scene_follows) {
    args.insert(args.begin(), "run");
  } else if (!flag) {
    const std::string hint = scene::suggestion(first, commands);
    throw Error(Exit::usage, "unknown command '" + first + "'\n  " + (hint.empty() ? "see 'mortise -h'" : hint));
  }
}

const CLI::App& chosen(const CLI::App& app) {
  const auto subs = app.get_subcommands();
  return subs.empty() ? app : *subs.front();
}

std::string usage_message(const CLI::App& app, const CLI::ParseError& e) {
  const CLI::App& command = chosen(app);
  const std::string name = &command == &app ? "mortise" : "mortise " + command.get_name();
  const std::string more = "\n  see '" + name + " -h'";
  const std::vector<std::string> rest = app.remaining(true);
  if (dynamic_cast<const CLI::ExtrasError*>(&e) && !rest.empty()) {
    const std::string flag = rest.front().substr(0, rest.front().find('='));
    if (flag.size() < 2 || flag[0] != '-') {
      const bool setting = rest.front().find('=') != std::string::npos;
      return "'" + name + "' takes no further argument '" + rest.front() + "'" + (setting ? "\n  every setting needs a --set of its own" : more);
    }
    std::vector<std::string> known;
    for (const CLI::Option* o : command.get_options()) {
      for (const std::string& l : o->get_lnames()) known.push_back("--" + l);
      if (flag.size() == 2)
        for (const std::string& s : o->get_snames()) known.push_back("-" + s);
    }
    const std::string near = scene::nearest(flag, known);
    return "'" + name + "' has no flag '" + flag + "'" + (near.empty() ? more : "\n  did you mean '" + near + "'?");
  }
  return std::string(e.what()) + more;
}

int run(std::vector<std::string> args) {
  Context context;
  CLI::App app("Contact simulation of soft, stiff and fixed bodies: a YAML scene in, fields and pictures out.", "mortise");
  app.set_version_flag("--version", version_text());
  app.add_option("--color", "colour of messages: auto, always, never");  // for the help text; taken out before parsing
  app.require_subcommand(0, 1);
  app.footer(kExamples);
  for (Add add : kCommands) add(Command(&app), context);

  take_colour(args);
  if (args.empty()) {
    std::cerr << app.help();
    return static_cast<int>(Exit::usage);
  }
  turn_help(args);
  insert_run(args, command_names(app));
  std::reverse(args.begin(), args.end());  // what CLI11 wants
  try {
    app.parse(args);
  } catch (const CLI::Success& e) {
    std::cout << (dynamic_cast<const CLI::CallForVersion*>(&e) ? version_text() + "\n" : chosen(app).help());
    finish_output();
    return 0;
  } catch (const CLI::ParseError& e) {
    throw Error(Exit::usage, usage_message(app, e));
  }
  if (!context.action) throw Error(Exit::usage, "name a command or a scene\n  see 'mortise -h'");
  const int code = context.action();
  finish_output();
  return code;
}

}  // namespace

int program(std::vector<std::string> arguments) {
  end_on_broken_pipe();
  scene::set_robot_reader(importers::scene_of_robot);
  scene::set_column_reader(output::read_column);
  geometry::tell_of_meshing([](const std::string& what, double tetrahedra) {
    print_wait(fmt::format("{}: filling it with about {:.2g} tetrahedra", what, std::max(tetrahedra, 1.0)));
  });
  try {
    return run(std::move(arguments));
  } catch (const Error& e) {
    print_error(e);
    return static_cast<int>(e.code());
  } catch (const std::bad_alloc&) {
    print_error("out of memory");
    return static_cast<int>(Exit::device);
  } catch (const std::exception& e) {
    print_error(std::string("internal: ") + e.what());
    return static_cast<int>(Exit::internal);
  }
}

void add_scene_options(Command command, std::string& scene, std::vector<std::string>& overrides) {
  command.option("scene", scene, "scene file; - reads the standard input").required();
  command
      .option("--set", overrides,
              "PATH=VALUE changes one value of the scene, e.g. bodies.pad.velocity.2=-0.1; PATH=null removes it (an effect, a body); the right-most "
              "wins; a --set for each")
      .one_each()
      .take_all();
}

void add_time_limits(Command command, TimeLimits& to) {
  const Flag walltime = command.time("--walltime", to.walltime, "stop with a checkpoint (exit 75) before so much time is over, e.g. '4 h'", true);
  command.time("--grace", to.grace, "how long before; a Newton iteration and a checkpoint have to fit in (default 60 s)").needs(walltime);
  command.time("--checkpoint-every", to.checkpoint_every,
               "a checkpoint after so much time, e.g. '10 min', in the place of the scene's `output.checkpoint_every` (absent: with frames, in at "
               "most a twentieth of the time)",
               true);
}

void TimeLimits::check() const {
  if (walltime > 0 && grace >= walltime)
    throw Error(Exit::usage, fmt::format("--walltime {:g} s leaves no time to run: it stops --grace {:g} s before", walltime, grace));
}

void add_device_option(Command command, std::string& device) {
  command.option("--device", device, engine::kDeviceHelp).environment_variable("MORTISE_DEVICE").show_default().check([](const std::string& name) {
    return engine::is_device_name(name) ? std::string() : "'" + name + "' is no device; must be auto, cpu, cuda, cuda:N or debug";
  });
}

void add_device_options(Command command, std::string& device, int& threads) {
  add_device_option(command, device);
  command.option("-j,--threads", threads, "CPU threads; default SLURM_CPUS_PER_TASK, else all that the process may use").positive();
}

}  // namespace mortise::cli
