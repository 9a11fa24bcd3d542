#pragma once
// Sums the stencils of all effects into the gradient and the Hessian, in an order that depends on nothing but the stencils:
// set after set, within a set in stencil order (grouping.h). A set is sorted again only when its version() changed; merging the
// structures of the sets costs one sort of their distinct blocks, and is skipped while no set changed.
#include <memory>
#include <optional>
#include <span>
#include <vector>

#include "device/room.h"
#include "linalg/block_matrix.h"
#include "linalg/grouping.h"
#include "linalg/stencils.h"

namespace mortise::linalg {

struct Merge;  // of the structures of several sets

class Assembler {
 public:
  Assembler();
  ~Assembler();
  // Environment e has the blocks [env_blocks[e], env_blocks[e+1]). Both are looked at in every call: while `whose` marks only some environments,
  // sums of the others' pieces are not taken.
  void set_environments(const std::vector<Index>& env_blocks, const std::vector<std::uint8_t>& whose) { env_blocks_ = &env_blocks, whose_ = &whose; }
  // Block b becomes row row_of_block[b] of the matrix; -1 leaves the block out. Rows are 0..rows-1, those of environment e begin at env_rows[e].
  void set_rows(Buffer<Index>&& row_of_block, Index rows, std::vector<Index> env_rows = {});

  // g[b] = sum of the gradient pieces of block b [N], for all blocks 0..blocks-1, those without a row included; of environments that are left out
  // it stays as it was.
  void gradient(std::span<StencilSet* const> sets, Index blocks, Buffer<Vec3>& g);

  // A = sum of the Hessian pieces [N/m] of the blocks that have rows; of environments that are left out it has zeros on the diagonal. A.pattern stays
  // when the structure did, even if sets were sorted again. All diagonal blocks exist. Sets must outlive the assembler.
  void matrix(std::span<StencilSet* const> sets, BlockMatrix& A);
  // What else `fetch` was asked for is brought too where the structure has to be asked for.
  void matrix(std::span<StencilSet* const> sets, BlockMatrix& A, device::Fetch& fetch);
  // Asks for the structure of that matrix: once `fetch` is done matrix() has it, of the sets as they are now.
  void begin_matrix(std::span<StencilSet* const> sets, device::Fetch& fetch);

 private:
  struct Sorted {
    const StencilSet* set = nullptr;
    bool has_grad = false, has_hess = false;
    std::uint64_t grad_version = 0, hess_version = 0;
    Index grad_blocks = 0;
    Grouping grad;               // by block
    Grouping hess;               // by block_key
    Buffer<std::uint8_t> place;  // how each Hessian piece enters: Entry in assembly.cpp
    device::Room room;           // for groups in `hess`, among pieces
    Index there = 0;             // how many there were
  };
  Sorted& sorted(const StencilSet* set);
  bool sort_hessians(std::span<StencilSet* const> sets, device::Fetch& fetch);  // false: none had changed
  bool had_room(std::span<StencilSet* const> sets);                             // true: what was sorted is whole
  bool begun(std::span<StencilSet* const> sets);                                // true: begin_matrix() was for these, and had room for them
  bool some() const { return whose_ && !whose_->empty(); }

  const std::vector<Index>* env_blocks_ = nullptr;
  const std::vector<std::uint8_t>* whose_ = nullptr;
  Buffer<Index> row_of_block_;
  Index rows_ = 0;
  std::vector<Index> env_rows_;
  std::vector<std::unique_ptr<Sorted>> sorted_;

  // Merged structure of `merged_`: distinct keys, and for every distinct key of every set its place among them.
  bool merge_valid_ = false;
  std::vector<const StencilSet*> merged_;
  std::vector<std::uint8_t> merged_whose_;
  Buffer<std::uint64_t> keys_;
  Buffer<Index> merge_place_;
  std::uint64_t pattern_ = 0;

  // Of begin_matrix(): the groups of the environments that are not left out, and the structure that is being merged, where it may have changed.
  std::optional<std::vector<StencilSet*>> begun_;
  std::vector<std::uint8_t> begun_whose_;
  std::vector<GroupsOf> only_;
  std::unique_ptr<Merge> merge_;
};

}  // namespace mortise::linalg
