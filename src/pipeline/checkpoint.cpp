// SPDX-License-Identifier: MIT
#include "pipeline/checkpoint.h"

#include <cstring>

#include "core/digest.h"
#include "core/file.h"

namespace swallowclip::pipeline {
namespace {
constexpr std::string_view kMark = "swallowclip checkpoint 2\n";

template <class T>
void put(std::string& to, const std::vector<T>& values) {
  const std::uint64_t n = values.size();
  to.append(reinterpret_cast<const char*>(&n), sizeof n);
  to.append(reinterpret_cast<const char*>(values.data()), values.size() * sizeof(T));
}

/// False when the bytes end before the list does.
template <class T>
bool get(std::string_view& from, std::vector<T>& values) {
  std::uint64_t n = 0;
  if (from.size() < sizeof n) return false;
  std::memcpy(&n, from.data(), sizeof n);
  from.remove_prefix(sizeof n);
  if (n > from.size() / sizeof(T)) return false;
  values.resize(n);
  if (n > 0) std::memcpy(static_cast<void*>(values.data()), from.data(), n * sizeof(T));
  from.remove_prefix(n * sizeof(T));
  return true;
}

template <class T>
bool getRows(std::string_view& from, std::size_t frames, std::vector<std::vector<T>>& rows) {
  rows.resize(frames);
  for (auto& row : rows)
    if (!get(from, row)) return false;
  return true;
}
}  // namespace

Result<void> writeCheckpoint(const std::filesystem::path& path, const bolus::Solver& solver,
                             const frame::History& h) {
  std::string out(kMark);
  out += h.meta.inputsSha256;
  put(out, h.ledger);
  const auto rows = [&](const auto& all) {
    for (const auto& row : all) put(out, row);
  };
  const frame::BolusTrack& b = h.bolus;
  rows(b.positions);
  rows(b.velocities);
  rows(b.densityRatio);
  rows(b.state);
  rows(b.region);
  rows(b.s_m);
  rows(b.lentShare);
  rows(h.skin.film_m);
  const std::string state = solver.save();
  put(out, std::vector<char>(state.begin(), state.end()));
  const std::uint64_t digest = stateDigest(out.data(), out.size());
  out.append(reinterpret_cast<const char*>(&digest), sizeof digest);
  return writeFile(path, out);
}

Result<void> readCheckpoint(const std::filesystem::path& path, bolus::Solver& solver,
                            frame::History& h) {
  auto bytes = readFile(path);
  if (!bytes) return std::unexpected(bytes.error());
  const auto refuse = [&](const char* problem) {
    return failure(path.string(), problem, "Remove it to start the run anew.");
  };
  std::uint64_t digest = 0;
  std::string_view in = *bytes;
  const std::size_t head = kMark.size() + h.meta.inputsSha256.size();
  if (in.size() < head + sizeof digest || !in.starts_with(kMark))
    return refuse("not a checkpoint of this version");
  std::memcpy(&digest, in.data() + in.size() - sizeof digest, sizeof digest);
  in.remove_suffix(sizeof digest);
  if (digest != stateDigest(in.data(), in.size())) return refuse("the checkpoint is damaged");
  if (in.substr(kMark.size(), h.meta.inputsSha256.size()) != h.meta.inputsSha256)
    return refuse("the checkpoint belongs to other inputs");
  in.remove_prefix(head);
  frame::BolusTrack& b = h.bolus;
  std::vector<char> state;
  if (!get(in, h.ledger)) return refuse("the checkpoint is cut short");
  const std::size_t frames = h.ledger.size();
  if (frames > in.size() || !getRows(in, frames, b.positions) ||
      !getRows(in, frames, b.velocities) || !getRows(in, frames, b.densityRatio) ||
      !getRows(in, frames, b.state) || !getRows(in, frames, b.region) ||
      !getRows(in, frames, b.s_m) ||
      (solver.coating().on() &&
       !(getRows(in, frames, b.lentShare) && getRows(in, frames, h.skin.film_m))) ||
      !get(in, state))
    return refuse("the checkpoint is cut short");
  return solver.restore({state.data(), state.size()});
}
}  // namespace swallowclip::pipeline
