// mortise merge: one table from the rows of a sweep.
#include "sweep/merge.h"

#include <fmt/format.h>

#include <iostream>
#include <memory>

#include "base/shell.h"
#include "cli/commands.h"

namespace mortise::cli {
namespace {

int cmd_merge(const std::string& folder, bool parquet) {
  using Is = sweep::Status::Is;
  const sweep::Merged m = sweep::merge(folder);
  std::cout << fmt::format("written: {} and {}/fields.h5 (links)\n", m.table, folder);
  if (parquet) {
    const std::string script =
        "import sys\ntry:\n import pyarrow.csv as c, pyarrow.parquet as p\nexcept ImportError as e:\n sys.exit('error: --parquet: python3: ' + "
        "str(e))\n"
        "p.write_table(c.read_csv(sys.argv[1]), sys.argv[2])";
    const std::string to = folder + "/table.parquet";
    if (std::system(("python3 -c " + shell_word(script) + " " + shell_word(m.table) + " " + shell_word(to)).c_str()) != 0)
      throw Error(Exit::file, "'" + to + "' was not written");
    std::cout << "written: " << to << "\n";
  }
  bool whole = true;
  for (Is is : {Is::done, Is::checks_failed, Is::failed, Is::stopped, Is::missing}) {
    const std::vector<std::size_t> rows = m.with(is);
    if (rows.empty()) continue;
    const bool again = is != Is::done && is != Is::checks_failed;
    whole = whole && !again;
    std::cout << fmt::format("{:>6} {}{}\n", rows.size(), sweep::name_of(is), again ? ": --array=" + sweep::ranges(rows) : "");
  }
  for (const std::string& one : m.unknown) std::cerr << "error: quantities: " << one << "\n";
  if (!m.unknown.empty()) return static_cast<int>(Exit::scene);
  return static_cast<int>(whole ? Exit::done : Exit::solve);
}

}  // namespace

void add_merge(Command app, Context& context) {
  const Command sub = app.command("merge", "gather what the rows of a sweep left in one table");
  auto folder = std::make_shared<std::string>();
  auto parquet = std::make_shared<bool>(false);
  sub.option("folder", *folder, "folder of the sweep").required();
  sub.flag("--parquet", *parquet, "also table.parquet, by python3 with pyarrow");
  sub.footer(
      "Rows that failed or are missing are listed as sbatch's --array takes them.\nExample:\n  mortise merge out/mu\nExit codes: 0 every row is "
      "finished, 3 rows do not have a quantity of the sweep's, 5 some failed or are missing (the table is written)");
  sub.action([=, &context] { context.action = [=] { return cmd_merge(*folder, *parquet); }; });
}

}  // namespace mortise::cli
