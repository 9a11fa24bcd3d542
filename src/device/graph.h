#pragma once
// A sequence of launches that is made once and repeated many times. On CUDA it is recorded into a graph, whose replay costs one
// call for all its launches; the CPU backend simply makes the launches again.
#include <functional>
#include <memory>

namespace mortise::device {

class Graph {
 public:
  Graph();
  ~Graph();
  Graph(const Graph&) = delete;
  Graph& operator=(const Graph&) = delete;

  // What `launches` launches, instead of what was recorded before; nothing runs yet. Only kernels may be launched: no memory
  // allocated or released, nothing copied from or to the host. The memory they touch must stay in its place until the last replay.
  void record(std::function<void()> launches);
  void replay(const char* name);

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace mortise::device
