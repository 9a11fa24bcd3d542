#include "output/environment_fields.h"

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <limits>
#include <map>
#include <optional>

#include "output/field_layout.h"
#include "output/h5.h"

namespace fs = std::filesystem;

namespace mortise::output {
namespace {

constexpr const char* kFile = "fields.vtkhdf";

// A dataset of one run that others have too.
struct Source {
  std::size_t environment;
  std::string run;      // folder
  hsize_t first, rows;  // frames or steps of the environment
};

// All environments' datasets of one path.
struct Stack {
  std::string from;    // path in the environments' files
  hsize_t block = 1;   // rows that belong to one frame
  int components = 1;  // 1: one-dimensional
  bool single = false;
  std::string unit = "1", description;
  std::vector<Source> sources;
};

// What VTK reads of one run.
struct Block {
  std::string run;
  hsize_t frames;
  std::vector<std::string> members;
};

class Writer {
 public:
  Writer(const std::string& folder, const std::vector<EnvironmentFields>& all)
      : folder_(folder), all_(all), file_(folder + "/" + kFile, h5::Mode::create) {}

  void write() {
    for (std::size_t e = 0; e < all_.size(); ++e) {
      hsize_t frames = 0, steps = 0;
      for (std::size_t r = 0; r < all_[e].runs.size(); ++r) read(e, r, frames, steps);
      frames_ = std::max(frames_, frames), most_steps_ = std::max(most_steps_, steps);
    }
    h5::set_text(file_, file_.id(), "filetype", "mortise environments");
    h5::set_integers(file_, file_.id(), "version", std::vector<std::int64_t>{1, 0});
    h5::set_integer(file_, file_.id(), "count", static_cast<std::int64_t>(all_.size()));
    if (!blocks_.empty()) collection();
    environments_ = h5::make_group(file_, file_.id(), "environments");
    table();
    stacks();
    file_.close();
  }

 private:
  // What a run's file has; other environments' meshes are the same. before: frames and steps of the environment's earlier runs; adds its own.
  void read(std::size_t e, std::size_t number, hsize_t& frames_before, hsize_t& steps_before) {
    const std::string& run = all_[e].runs[number];
    const std::string path = folder_ + "/" + run + "/" + kFile;
    std::error_code ec;
    if (!fs::exists(path, ec)) return;
    const h5::File file(path, h5::Mode::read);
    const h5::Id root = h5::open_group(file, file.id(), "VTKHDF"), steps = h5::open_group(file, root, "Steps");
    const auto frames = static_cast<hsize_t>(h5::get_integer(file, steps, "NSteps"));
    const auto one = [&](const char* name) { return static_cast<hsize_t>(h5::Table::open(file, root, name).read<std::int64_t>(file, 0, 1)[0]); };
    const hsize_t points = one("NumberOfPoints"), cells = one("NumberOfCells");
    if (frames == 0 || (points_ > 0 && (points != points_ || cells != cells_))) return;
    points_ = points, cells_ = cells;
    blocks_.push_back({run, frames, h5::members(file, root)});
    episodes_.push_back({e, run, frames_before, frames});
    episode_.push_back(static_cast<std::int32_t>(number));
    const Source own{e, run, frames_before, frames};
    frames_before += frames;
    if (frames > times_.size()) times_ = h5::Table::open(file, steps, "Values").read<double>(file, 0, frames);

    add(file, root, "VTKHDF/Points", "Points", points, own);
    add(file, steps, "VTKHDF/Steps/Values", "time", 1, own);
    for (const auto& [group, block] : {std::pair{"PointData", points}, {"CellData", cells}}) {
      const h5::Id data = h5::open_group(file, root, group);
      for (const std::string& name : h5::members(file, data))
        if (name != body_field) add(file, data, std::string("VTKHDF/") + group + "/" + name, std::string(group) + "/" + name, block, own);
    }
    const h5::Id ours = h5::open_group(file, file.id(), "mortise"), effects = h5::open_group(file, ours, "effects"),
                 table = h5::open_group(file, ours, "steps");
    for (const std::string& effect : h5::members(file, effects)) {
      const h5::Id group = h5::open_group(file, effects, effect);
      const bool tables = h5::exists(file, group, "row_offset");
      const h5::Id offsets = tables ? h5::open_group(file, group, "row_offset") : h5::Id();
      for (const std::string& name : h5::members(file, group))  // a table whose number of rows changes has no such axis
        if (!h5::is_group(file, group, name) && !(tables && h5::exists(file, offsets, name)))
          add(file, group, "mortise/effects/" + effect + "/" + name, "effects/" + effect + "/" + name, 1, own);
    }
    hsize_t rows = 0;
    for (const std::string& column : h5::members(file, table)) {
      const h5::Table t = h5::Table::open(file, table, column);
      rows = t.rows();
      if (rows > 0) add(file, table, "mortise/steps/" + column, "steps/" + column, 1, {e, run, steps_before, rows});
    }
    steps_before += rows;
  }

  void add(const h5::File& file, hid_t parent, const std::string& from, const std::string& to, hsize_t block, Source source) {
    const std::string name = from.substr(from.rfind('/') + 1);
    const h5::Table t = h5::Table::open(file, parent, name);
    if (t.rows() < source.rows * block) return;
    Stack& stack = stacks_[to];
    if (stack.sources.empty()) {
      stack.from = "/" + from, stack.block = block, stack.components = t.components(), stack.single = t.single(), stack.unit = t.unit(file);
      if (H5Aexists(t.id(), "description") > 0) stack.description = h5::get_text(file, t.id(), "description");
    }
    if (t.components() == stack.components) stack.sources.push_back(source);
  }

  // A group whose members VTK visits in the order in which they were made: without it, it takes none.
  h5::Id ordered_group(hid_t parent, const std::string& name) const {
    const h5::Id order(file_.check(H5Pcreate(H5P_GROUP_CREATE), "make group " + name));
    file_.check(H5Pset_link_creation_order(order, H5P_CRT_ORDER_TRACKED | H5P_CRT_ORDER_INDEXED), "make group " + name);
    return h5::Id(file_.check(H5Gcreate2(parent, name.c_str(), H5P_DEFAULT, order, H5P_DEFAULT), "make group " + name));
  }
  void type(hid_t group, const char* name) const {
    h5::set_integers(file_, group, "Version", std::vector<std::int64_t>{2, 2});
    h5::set_fixed_ascii(file_, group, "Type", name);
  }

  // An environment that ended early shows its last frame for the rest of the time: VTK asks all blocks for all times.
  void stand_still(const Block& block, hid_t group) const {
    const h5::File there(folder_ + "/" + block.run + "/" + kFile, h5::Mode::read);
    const h5::Id from = h5::open_group(there, there.id(), "VTKHDF/Steps"), to = h5::make_group(file_, group, "Steps");
    h5::set_integer(file_, to, "NSteps", static_cast<std::int64_t>(times_.size()));
    h5::Table::create(file_, to, "Values", {.type = H5T_IEEE_F64LE, .unit = "s"}).write<double>(file_, 0, times_);
    const auto longer = [&](hid_t source, hid_t target, const std::string& name, bool column) {
      std::vector<std::int64_t> rows = h5::Table::open(there, source, name).read<std::int64_t>(there, 0, block.frames);
      rows.resize(times_.size(), rows.back());
      h5::Table::create(file_, target, name, {.type = H5T_STD_I64LE, .column = column}).write<std::int64_t>(file_, 0, rows);
    };
    for (int i = number_of_parts; i <= connectivity_offsets; ++i)
      longer(from, to, step_index_names[i], i == cell_offsets || i == connectivity_offsets);
    for (const char* of : {"PointDataOffsets", "CellDataOffsets"}) {
      const h5::Id source = h5::open_group(there, from, of), target = h5::make_group(file_, to, of);
      for (const std::string& name : h5::members(there, source)) longer(source, target, name, false);
    }
  }

  // Blocks whose members are links to those of the environments' files; the times are those of the longest.
  void collection() const {
    const h5::Id root = ordered_group(file_.id(), "VTKHDF");
    type(root, "MultiBlockDataSet");
    const h5::Id assembly = ordered_group(root, "Assembly");
    for (const Block& block : blocks_) {
      std::string name = block.run;  // env_0007_episode_0003
      std::replace(name.begin(), name.end(), '/', '_');
      const h5::Id group = ordered_group(root, name);
      type(group, "UnstructuredGrid");
      if (block.frames < times_.size()) stand_still(block, group);
      for (const std::string& member : block.members)
        if (!h5::exists(file_, group, member))
          file_.check(
              H5Lcreate_external((block.run + "/" + kFile).c_str(), ("/VTKHDF/" + member).c_str(), group, member.c_str(), H5P_DEFAULT, H5P_DEFAULT),
              "link " + name);
      file_.check(H5Lcreate_soft(("/VTKHDF/" + name).c_str(), assembly, name.c_str(), H5P_DEFAULT, H5P_DEFAULT), "link " + name);
    }
    const h5::Id steps = h5::make_group(file_, root, "Steps");
    h5::set_integer(file_, steps, "NSteps", static_cast<std::int64_t>(times_.size()));
    h5::Table::create(file_, steps, "Values", {.type = H5T_IEEE_F64LE, .unit = "s"}).write<double>(file_, 0, times_);
  }

  // How every environment ended, and what was drawn for it.
  void table() {
    std::vector<std::int64_t> codes;
    std::string folders;
    for (const EnvironmentFields& e : all_) codes.push_back(e.exit_code), folders += e.folder + "\n";
    h5::Table::create(file_, environments_, "exit_code",
                      {.type = H5T_STD_I64LE, .description = "exit code of every environment's run; -1: it never began"})
        .write<std::int64_t>(file_, 0, codes);
    h5::write_text(file_, environments_, "folders", folders);
    std::string runs;
    for (const Block& block : blocks_) runs += block.run + "\n";
    h5::write_text(file_, environments_, "runs", runs);
    episodes();
    const h5::Id values = h5::make_group(file_, environments_, "values");
    if (all_.empty()) return;
    for (std::size_t v = 0; v < all_[0].values.size(); ++v) {
      std::vector<double> column;
      for (const EnvironmentFields& e : all_) column.push_back(e.values[v].second);
      h5::Table::create(file_, values, all_[0].values[v].first, {.type = H5T_IEEE_F64LE, .unit = "SI", .description = "drawn for every environment"})
          .write<double>(file_, 0, column);
    }
  }

  // Which episode a frame is of; only where resets made several.
  void episodes() const {
    if (frames_ == 0 || std::count(episode_.begin(), episode_.end(), 0) == static_cast<std::ptrdiff_t>(episode_.size())) return;
    std::vector<std::int32_t> of(all_.size() * frames_, -1);
    for (std::size_t i = 0; i < episodes_.size(); ++i)
      for (hsize_t f = 0; f < episodes_[i].rows; ++f) of[episodes_[i].environment * frames_ + episodes_[i].first + f] = episode_[i];
    h5::Table::create(file_, environments_, "episode",
                      {.type = H5T_STD_I32LE,
                       .components = static_cast<int>(frames_),
                       .column = true,
                       .description = "episode that a frame belongs to; -1: there is no such frame"})
        .write<std::int32_t>(file_, 0, of);
  }

  void stacks() {
    std::map<std::string, h5::Id> groups;
    for (const auto& [to, stack] : stacks_) {
      hid_t parent = environments_;
      std::string name = to;
      for (std::size_t at, from = 0; (at = to.find('/', from)) != std::string::npos; from = at + 1) {
        const std::string path = to.substr(0, at);
        if (!groups.contains(path)) groups[path] = h5::make_group(file_, parent, to.substr(from, at - from));
        parent = groups[path];
        name = to.substr(at + 1);
      }
      stack_up(stack, parent, name, to.rfind("steps/", 0) == 0 ? most_steps_ : frames_);
    }
  }

  // (environments, frames, rows of a frame, components); the last two only where there are more than one.
  void stack_up(const Stack& s, hid_t parent, const std::string& name, hsize_t largest) {
    std::vector<hsize_t> shape{all_.size(), largest};
    if (s.block > 1) shape.push_back(s.block);
    if (s.components > 1) shape.push_back(static_cast<hsize_t>(s.components));
    const auto rank = static_cast<int>(shape.size());
    const h5::Id space(file_.check(H5Screate_simple(rank, shape.data(), nullptr), "make " + name));
    const h5::Id creation = h5::new_layout(file_, "make " + name);
    const double nothing = std::numeric_limits<double>::quiet_NaN();
    file_.check(H5Pset_fill_value(creation, H5T_NATIVE_DOUBLE, &nothing), "make " + name);
    for (const Source& source : s.sources) {
      std::vector<hsize_t> start(rank, 0), count = shape;
      start[0] = source.environment, start[1] = source.first, count[0] = 1, count[1] = source.rows;
      file_.check(H5Sselect_hyperslab(space, H5S_SELECT_SET, start.data(), nullptr, count.data(), nullptr), "make " + name);
      const std::vector<hsize_t> there = s.components > 1 ? std::vector<hsize_t>{source.rows * s.block, static_cast<hsize_t>(s.components)}
                                                          : std::vector<hsize_t>{source.rows * s.block};
      const h5::Id from(file_.check(H5Screate_simple(static_cast<int>(there.size()), there.data(), nullptr), "make " + name));
      const std::string path = source.run + "/" + kFile;
      file_.check(H5Pset_virtual(creation, space, path.c_str(), s.from.c_str(), from), "make " + name);
    }
    file_.check(H5Sselect_all(space), "make " + name);
    const h5::Id set(file_.check(
        H5Dcreate2(parent, name.c_str(), s.single ? H5T_IEEE_F32LE : H5T_IEEE_F64LE, space, H5P_DEFAULT, creation, H5P_DEFAULT), "make " + name));
    h5::set_text(file_, set, "unit", s.unit);
    if (!s.description.empty()) h5::set_text(file_, set, "description", s.description);
  }

  const std::string folder_;
  const std::vector<EnvironmentFields>& all_;
  h5::File file_;
  h5::Id environments_;
  std::vector<Block> blocks_;
  std::vector<Source> episodes_;       // frames of every run,
  std::vector<std::int32_t> episode_;  // and its number in its environment
  std::vector<double> times_;
  std::map<std::string, Stack> stacks_;  // by their path under /environments
  hsize_t points_ = 0, cells_ = 0, frames_ = 0, most_steps_ = 0;
};

}  // namespace

void write_environment_fields(const std::string& folder, const std::vector<EnvironmentFields>& all) { Writer(folder, all).write(); }

}  // namespace mortise::output
