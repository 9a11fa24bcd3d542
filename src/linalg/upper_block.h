#pragma once
#include <cstdint>

namespace mortise::linalg {

// Matrices keep their upper blocks: how a piece H_ij that belongs to the rows a and b enters the block of the two.
enum UpperBlock : std::uint8_t {
  direct,      // a <= b: H_ij
  transposed,  // a > b: H_ij^T
  both         // i != j meet in the same row: H_ij and H_ji = H_ij^T fall on its diagonal block
};

}  // namespace mortise::linalg
