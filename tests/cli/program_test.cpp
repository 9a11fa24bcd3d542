// The command line itself: streams, exit codes, suggestions, schema drift.
#include "program.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <csignal>
#include <nlohmann/json.hpp>
#include <vector>

#include "../scene/check_table.h"
#include "cli/commands.h"
#include "engine/effect_tables.h"

namespace mortise::cli {
namespace {

using testing::HasSubstr;
using testing::Not;
namespace fs = std::filesystem;
const std::string kScene = "scenes/first/01_free_fall.yaml";

std::vector<std::string> scenes() {
  std::vector<std::string> out;
  for (const auto& entry : fs::recursive_directory_iterator(kSource + "/scenes"))
    if (entry.path().extension() == ".yaml") out.push_back(fs::relative(entry.path(), kSource));
  return out;
}

TEST(Program, HelpHasExamplesOnStdout) {
  const Result r = mortise("-h");
  EXPECT_EQ(r.code, 0);
  EXPECT_THAT(r.out, HasSubstr("Examples:"));
  EXPECT_EQ(r.err, "");
  EXPECT_THAT(mortise("check -h").out, HasSubstr("--print-resolved"));
}

// A study's file was told to say its format version, a scene that every key of it is unknown in a sweep.
TEST(Program, SaysWhichCommandReadsAFile) {
  const std::string folder = (fs::temp_directory_path() / ("mortise_kinds_" + std::to_string(getpid()))).string();
  fs::create_directories(folder);
  std::ofstream(folder + "/study.yaml") << "mortise_study: 1\nscene: a.yaml\n";
  std::ofstream(folder + "/sweep.yaml") << "mortise_sweep: 1\nscene: a.yaml\n";
  const auto said = [&](const std::string& arguments) {
    const Result r = mortise(arguments);
    EXPECT_EQ(r.code, 3) << arguments;
    EXPECT_EQ(r.err.find("error:"), r.err.rfind("error:")) << "one mistake, one message: " << r.err;
    return r.err;
  };
  for (const char* command : {"run ", "check "}) {
    EXPECT_THAT(said(command + folder + "/study.yaml"), HasSubstr("this is the file of a study, not a scene"));
    EXPECT_THAT(said(command + folder + "/sweep.yaml"), HasSubstr("'mortise sweep " + folder + "/sweep.yaml' runs it"));
  }
  EXPECT_THAT(said("sweep " + kScene), HasSubstr("this is a scene, not the file of a sweep"));
  EXPECT_THAT(said("sweep " + folder + "/study.yaml"), HasSubstr("'mortise study "));
  fs::remove_all(folder);
}

TEST(Program, AForgottenValueIsNotTheNextFlag) {
  const Result r = mortise("study " + kScene + " --sensitivity --dry-run --qoi gravity/energy");
  EXPECT_EQ(r.code, 2);
  EXPECT_THAT(r.err, HasSubstr("'--dry-run' is a flag where a value is wanted"));
  EXPECT_THAT(mortise("check " + kScene + " --set time.steps=2 time.steps=3").err, HasSubstr("every setting needs a --set of its own"));
}

// "0-5" was frame 0, "2.7" frame 2.
TEST(Program, FramesAreReadStrictly) {
  for (const char* bad : {"0-5", "2x", "2.7", "2:4abc", "5:3", "-1", ":", "1:2:3"}) {
    for (const std::string& command : {std::string("export nowhere -o x.glb"), "render " + kScene + " nowhere.vtkhdf"}) {
      const Result r = mortise(command + " --frames=" + bad);
      EXPECT_EQ(r.code, 2) << bad;
      EXPECT_THAT(r.err, HasSubstr(std::string("--frames is '") + bad + "'")) << bad;
    }
  }
  const Result run = mortise("run " + kScene + " --frames 1e3");
  EXPECT_EQ(run.code, 2);
  EXPECT_THAT(run.err, HasSubstr("'1e3' must be a whole number"));
}

TEST(Program, WithoutArgumentsIsAUsageError) {
  const Result r = mortise("");
  EXPECT_EQ(r.code, 2);
  EXPECT_EQ(r.out, "");
  EXPECT_THAT(r.err, HasSubstr("check"));
}

TEST(Program, UnknownCommandIsSuggested) {
  const Result r = mortise("chek x.yaml");
  EXPECT_EQ(r.code, 2);
  EXPECT_THAT(r.err, HasSubstr("did you mean 'check'?"));
  EXPECT_THAT(mortise("absolutely_else").err, HasSubstr("see 'mortise -h'"));
}

TEST(Program, HelpIsACommandToo) {
  EXPECT_EQ(mortise("help").out, mortise("-h").out);
  EXPECT_EQ(mortise("help check").out, mortise("check -h").out);
  EXPECT_EQ(mortise("help chek").code, 2);
}

TEST(Program, UnknownFlagIsSuggested) {
  const Result r = mortise("check --print-resolvd " + kScene);
  EXPECT_EQ(r.code, 2);
  EXPECT_THAT(r.err, HasSubstr("did you mean '--print-resolved'?"));
  EXPECT_EQ(mortise("check --set").code, 2);
  EXPECT_EQ(mortise("--colour never").code, 2);
  EXPECT_EQ(mortise("--color sometimes info").code, 2);
}

TEST(Program, MissingFileIsAFileError) {
  const Result r = mortise("check no_such.yaml");
  EXPECT_EQ(r.code, 6);
  EXPECT_EQ(r.err, "error: cannot read 'no_such.yaml': No such file or directory\n");
  EXPECT_EQ(mortise("check scenes").code, 6);
}

TEST(Program, AFullDiskIsAFileError) { EXPECT_EQ(WEXITSTATUS(std::system((quoted(kProgram) + " schema >/dev/full 2>/dev/null").c_str())), 6); }

TEST(Program, BrokenPipeEndsQuietly) {
  const std::string folder = fs::temp_directory_path(), err = folder + "/mortise_pipe_" + std::to_string(getpid());
  // bash reports the exit code of the left side; `true` reads nothing.
  const std::string command = "bash -c " + quoted(quoted(kProgram) + " schema 2>" + quoted(err) + " | (sleep 0.2; true); exit ${PIPESTATUS[0]}");
  EXPECT_EQ(WEXITSTATUS(std::system(command.c_str())), 128 + SIGPIPE);
  EXPECT_EQ(read_text(err), "");
  fs::remove(err);
}

TEST(Program, ColourOnlyWhenAskedOrOnATerminal) {
  EXPECT_THAT(mortise("check no_such.yaml").err, Not(HasSubstr("\033")));
  EXPECT_THAT(mortise("--color always check no_such.yaml").err, HasSubstr("\033[1;31merror:\033[0m cannot read"));
  // A terminal that `script` makes; a chroot without /dev/pts has none.
  if (std::system("script -qc true /dev/null >/dev/null 2>&1") != 0) GTEST_SKIP() << "no terminal can be made here by `script`";
  const auto on_terminal = [](const std::string& environment) {
    const std::string file = fs::temp_directory_path() / ("mortise_tty_" + std::to_string(getpid()));
    const int status =
        std::system(("script -qc " + quoted("env " + environment + " " + kProgram + " check no_such.yaml") + " /dev/null >" + quoted(file)).c_str());
    EXPECT_EQ(status, 0);
    const std::string seen = read_text(file);
    fs::remove(file);
    EXPECT_THAT(seen, HasSubstr("cannot read"));
    return seen.find("\033[1;31m") != std::string::npos;
  };
  EXPECT_TRUE(on_terminal("-u NO_COLOR TERM=xterm"));
  EXPECT_FALSE(on_terminal("NO_COLOR=1 TERM=xterm"));
  EXPECT_FALSE(on_terminal("-u NO_COLOR TERM=dumb"));
}

TEST(Program, ASceneAloneIsRun) {
  const fs::path out = fs::temp_directory_path() / ("mortise_run_" + std::to_string(getpid()));
  const Result r = mortise(kScene + " -q -o " + quoted(out));
  EXPECT_EQ(r.code, 0) << r.err;
  EXPECT_TRUE(fs::exists(out / "run.json"));
  EXPECT_EQ(mortise("-q -o " + quoted(out) + " --overwrite " + kScene).code, 0);
  fs::remove_all(out);
}

// What is wrong with a scene is said in one way, by whatever finds it.
TEST(Program, RunsNameThePlaceOfAnErrorAsChecksDo) {
  const std::string wrong = kScene + " --set " + quoted("effects.joint=[{type: revolute, body: box}]");
  const fs::path out = fs::temp_directory_path() / ("mortise_run_" + std::to_string(getpid()));
  const Result run = mortise("run -q -o " + quoted(out) + " " + wrong), check = mortise("check " + wrong);
  EXPECT_EQ(run.code, 3);
  EXPECT_THAT(run.err, testing::StartsWith("--set effects.joint=[{type: revolute, body: box}]: error: a revolute joint needs 'at'"));
  EXPECT_EQ(run.err, check.err);
  fs::remove_all(out);
}

TEST(Check, SummarisesOnStdout) {
  const Result r = mortise("check " + kScene);
  EXPECT_EQ(r.code, 0) << r.err;
  EXPECT_EQ(r.err, "");
  EXPECT_THAT(r.out, HasSubstr(kScene + ": valid: 1 body (1 "));
}

TEST(Check, ReadsTheStandardInput) {
  const Result r = mortise("check -", kSource, "cat " + kScene + " |");
  EXPECT_EQ(r.code, 0) << r.err;
  EXPECT_THAT(r.out, HasSubstr("<stdin>: valid"));
}

TEST(Check, RightMostOverrideWins) {
  const Result r = mortise("check --print-resolved --set time.steps=7 --set time.steps=8 " + kScene);
  EXPECT_EQ(r.code, 0) << r.err;
  EXPECT_THAT(r.out, HasSubstr("steps: 8"));
}

TEST(Check, ResolvedSceneReadsBackToItself) {
  for (const std::string& scene : scenes()) {
    const Result once = mortise("check --print-resolved " + scene);
    ASSERT_EQ(once.code, 0) << once.err;
    const std::string file = fs::temp_directory_path() / ("mortise_resolved_" + std::to_string(getpid()) + ".yaml");
    std::ofstream(file) << once.out;
    const Result twice = mortise("check --print-resolved " + quoted(file));
    EXPECT_EQ(twice.out, once.out) << twice.err;
    fs::remove(file);
  }
}

TEST(Check, PlanListsEffectsAndSensors) {
  const Result r = mortise("check --plan scenes/tactile/taxels.yaml");
  EXPECT_EQ(r.code, 0) << r.err;
  EXPECT_NE(r.out.find("effect  mortar_contact\n"), std::string::npos);
  EXPECT_NE(r.out.find("16 x 16 taxels on 'pad'\n"), std::string::npos);
}

TEST(Scenes, AreValidAndNameTheirSchema) {
  ASSERT_GE(scenes().size(), 5u);
  for (const std::string& scene : scenes()) {
    const Result r = mortise("check --quick " + scene);
    EXPECT_EQ(r.code, 0) << r.err;
    std::string up;
    for (auto p = fs::path(scene).parent_path(); !p.empty(); p = p.parent_path()) up += "../";
    const std::string modeline = "# yaml-language-server: $schema=" + up + "schemas/scene.schema.json\n";
    EXPECT_EQ(read_text(kSource + "/" + scene).rfind(modeline, 0), 0u) << scene << " must start with: " << modeline;
  }
}

TEST(Schema, FileIsWhatTheProgramPrints) {
  const std::string file = kSource + "/schemas/scene.schema.json";
  const Result r = mortise("schema");
  ASSERT_EQ(r.code, 0) << r.err;
  if (std::getenv("MORTISE_UPDATE_GOLDEN")) std::ofstream(file, std::ios::binary) << r.out;
  EXPECT_TRUE(r.out == read_text(file)) << "the tables changed: mortise schema > schemas/scene.schema.json";
}

TEST(Schema, DescribesUnitsAndForbidsUnknownKeys) {
  const auto schema = nlohmann::json::parse(mortise("schema").out);
  EXPECT_EQ(schema["$schema"], "http://json-schema.org/draft-07/schema#");
  EXPECT_EQ(schema["else"]["additionalProperties"], false);
  const auto& step = schema["else"]["properties"]["time"]["properties"]["step"];
  EXPECT_EQ(step["description"].get<std::string>().rfind("[s] ", 0), 0u);
  EXPECT_EQ(step["exclusiveMinimum"], 0.0);
  const auto& effects = schema["else"]["properties"]["effects"];
  EXPECT_EQ(effects["additionalProperties"], false);
  EXPECT_TRUE(effects["properties"].contains("gravity"));
}

TEST(Effects, TablesAreSound) {
  const std::vector<scene::EffectTable> effects = engine::effect_tables();
  scene::check_table(scene::SceneTables(effects).root(), "scene");
}

TEST(Effects, ListAndExplain) {
  EXPECT_THAT(mortise("effects").out, HasSubstr("gravity"));
  const Result r = mortise("effects gravity");
  EXPECT_THAT(r.out, HasSubstr("acceleration  [x, y, z] [m/s^2], default [0, 0, -9.81]"));
  const Result typo = mortise("effects gravty");
  EXPECT_EQ(typo.code, 2);
  EXPECT_THAT(typo.err, HasSubstr("did you mean 'gravity'?"));
}

TEST(Info, JsonNamesVersionAndDevices) {
  const Result r = mortise("info --json");
  const auto info = nlohmann::json::parse(r.out);
  EXPECT_EQ(info["devices"][0]["kind"], "cpu");
  EXPECT_GE(info["devices"][0]["threads"], 1);
  EXPECT_THAT(mortise("--version").out, HasSubstr("mortise " + info["version"].get<std::string>()));
  EXPECT_THAT(mortise("info").out, HasSubstr("yaml-cpp 0."));
}

}  // namespace
}  // namespace mortise::cli
