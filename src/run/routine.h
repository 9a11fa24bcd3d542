#pragma once
// Work that stops where it has to wait for somebody and goes on from there when that is done: a coroutine. Routines may await routines.
#include <coroutine>
#include <exception>
#include <optional>
#include <utility>

namespace mortise::run {

template <class T>
class [[nodiscard]] Routine {
 public:
  struct promise_type;
  using Handle = std::coroutine_handle<promise_type>;
  struct Back {  // to who awaits it
    bool await_ready() noexcept { return false; }
    std::coroutine_handle<> await_suspend(Handle ended) noexcept {
      const std::coroutine_handle<> caller = ended.promise().caller;
      return caller ? caller : std::noop_coroutine();
    }
    void await_resume() noexcept {}
  };
  struct promise_type {
    std::optional<T> value;
    std::exception_ptr error;
    std::coroutine_handle<> caller;
    Routine get_return_object() { return Routine(Handle::from_promise(*this)); }
    std::suspend_always initial_suspend() noexcept { return {}; }
    Back final_suspend() noexcept { return {}; }
    void return_value(T v) { value = std::move(v); }
    void unhandled_exception() { error = std::current_exception(); }
  };

  Routine(Routine&& other) noexcept : handle_(std::exchange(other.handle_, {})) {}
  Routine& operator=(Routine&&) = delete;
  ~Routine() {
    if (handle_) handle_.destroy();
  }

  void start() { handle_.resume(); }
  bool done() const { return handle_.done(); }
  // Of one that is done; throws what it threw.
  T result() const {
    if (handle_.promise().error) std::rethrow_exception(handle_.promise().error);
    return *handle_.promise().value;
  }

  bool await_ready() const noexcept { return false; }
  Handle await_suspend(std::coroutine_handle<> caller) noexcept {
    handle_.promise().caller = caller;
    return handle_;
  }
  T await_resume() const { return result(); }

 private:
  explicit Routine(Handle handle) : handle_(handle) {}
  Handle handle_;
};

}  // namespace mortise::run
