#include "device/graph.h"

#include "base/error.h"
#include "device/device.h"

namespace mortise::device {

#ifdef __CUDACC__

// Kernels go to a stream of the graph's own while it records; replays go where all other launches go.
struct Graph::State {
  cudaStream_t stream = nullptr;
  cudaGraphExec_t exec = nullptr;
  State() { check(cudaStreamCreateWithFlags(&stream, cudaStreamNonBlocking), "graph"); }
  ~State() {
    clear();
    cudaStreamDestroy(stream);
  }
  void clear() {
    if (exec) cudaGraphExecDestroy(exec);
    exec = nullptr;
  }
};

void Graph::record(std::function<void()> launches) {
  if (!state_) state_ = std::make_unique<State>();
  state_->clear();
  cudaGraph_t graph = nullptr;
  check(cudaStreamBeginCapture(state_->stream, cudaStreamCaptureModeThreadLocal), "graph");
  launch_stream = state_->stream;
  try {
    launches();
  } catch (...) {
    launch_stream = nullptr;
    cudaStreamEndCapture(state_->stream, &graph);
    if (graph) cudaGraphDestroy(graph);
    throw;
  }
  launch_stream = nullptr;
  check(cudaStreamEndCapture(state_->stream, &graph), "graph");
  const cudaError_t made = cudaGraphInstantiate(&state_->exec, graph, 0);
  cudaGraphDestroy(graph);
  check(made, "graph");
}

void Graph::replay(const char* name) {
  if (!state_ || !state_->exec) throw Error(Exit::internal, "a graph is replayed that was never recorded");
  count_launch(name);
  check(cudaGraphLaunch(state_->exec, nullptr), name);
}

#else

struct Graph::State {
  std::function<void()> launches;
};

void Graph::record(std::function<void()> launches) {
  if (!state_) state_ = std::make_unique<State>();
  state_->launches = std::move(launches);
}

void Graph::replay(const char*) {
  if (!state_ || !state_->launches) throw Error(Exit::internal, "a graph is replayed that was never recorded");
  state_->launches();
}

#endif

Graph::Graph() = default;
Graph::~Graph() = default;

}  // namespace mortise::device
