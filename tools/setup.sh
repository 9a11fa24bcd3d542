# Sourced by tools/mortise and tools/test: installs what is missing and builds. Needs root (or sudo) only to install.
set -euo pipefail
root=$(cd "$(dirname "${BASH_SOURCE[0]}")/.." && pwd)
build=${MORTISE_BUILD:-$root/build/release}

build_packages=(g++ cmake ninja-build ccache libeigen3-dev libsuitesparse-dev libmetis-dev libopenblas-dev libassimp-dev libhdf5-dev zlib1g-dev libyaml-cpp-dev
  libcli11-dev libpugixml-dev libtbb-dev libosmesa6-dev libpng-dev libstb-dev fonts-dejavu-core libfmt-dev nlohmann-json3-dev libcgal-dev libgmp-dev libmpfr-dev)
test_packages=(libgtest-dev libgmock-dev python3 python3-venv valgrind)
slurm_packages=(slurmctld slurmd slurm-client munge)  # tests/slurm/run

say() { printf 'mortise setup: %s\n' "$*" >&2; }

install_missing() {
  local missing=() p
  for p in "$@"; do
    [[ $(dpkg-query -W -f='${Status}' "$p" 2>/dev/null) == 'install ok installed' ]] || missing+=("$p")
  done
  ((${#missing[@]})) || return 0
  local as_root=()
  if ((EUID != 0)); then
    command -v sudo >/dev/null || { say "missing packages: ${missing[*]}; run as root: apt-get install ${missing[*]}"; exit 6; }
    as_root=(sudo)
  fi
  say "installing ${missing[*]}"
  "${as_root[@]}" env DEBIAN_FRONTEND=noninteractive apt-get update -qq >&2
  "${as_root[@]}" env DEBIAN_FRONTEND=noninteractive apt-get install -y -qq --no-install-recommends "${missing[@]}" >&2
}

# Python packages for the tests, in $venv. A current VTK reads our files back as ParaView would; Debian's own is too old for temporal VTKHDF.
venv=$root/.venv
venv_ready() {
  local stamp=$venv/.ready-1
  [[ ! -f $stamp ]] || return 0
  say "setting up Python packages for the tests in .venv"
  /usr/bin/python3 -m venv "$venv"
  "$venv/bin/pip" install -q --disable-pip-version-check 'vtk>=9.3' numpy h5py jsonschema pyyaml >&2
  touch "$stamp"
}

# The CUDA module is built where there is a GPU to run it, for that GPU only; `.ci/run` builds it wherever nvcc is found.
configure() {
  [[ -f $build/build.ninja ]] && return 0
  local cuda=(-DMORTISE_CUDA=OFF)
  if command -v nvidia-smi >/dev/null && nvidia-smi -L >/dev/null 2>&1; then
    cuda=(-DMORTISE_CUDA=AUTO -DMORTISE_CUDA_ARCHITECTURES=native)
  fi
  say "configuring $build"
  mkdir -p "$build"
  cmake -S "$root" -B "$build" -G Ninja -DCMAKE_BUILD_TYPE=Release "${cuda[@]}" "$@" >"$build/configure.log" 2>&1 || {
    cat "$build/configure.log" >&2
    rm -f "$build/build.ninja"
    exit 1
  }
}

# compile TARGET...: quiet when there is nothing to do.
compile() {
  if ! ninja -C "$build" -n "$@" 2>/dev/null | grep -q 'no work to do'; then
    say "building $*"
    ninja -C "$build" "$@" >&2
  fi
}

# Lets the compiler cache serve other checkouts of the same sources.
export CCACHE_BASEDIR=$root CCACHE_NOHASHDIR=1
