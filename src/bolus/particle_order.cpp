// SPDX-License-Identifier: MIT
// Where particles lie in memory. Sweeps go through slots, which lie as cells do, but what belongs
// to a particle is found by its number, and stirred numbers are found all over the memory: at
// 40,000 of them a step takes a fifth longer. So many are renumbered now and then, and called by
// their first numbers again where anybody outside looks at them.
#include <algorithm>

#include "bolus/solver_impl.h"

namespace swallowclip::bolus {
namespace {
constexpr std::size_t kManyParticles = 8192;  // more than caches hold, assumed (4,000 to 20,000)
constexpr int kSortSteps = 50;                // assumed (20 to 200): it takes a third of a step

/// to[k] = from[order[k]]
template <class T>
void take(std::vector<T>& all, const std::vector<int>& order) {
  if (all.size() != order.size()) return;  // not used in this run
  std::vector<T> sorted;
  sorted.reserve(all.size());
  for (const int p : order) sorted.push_back(std::move(all[p]));
  all.swap(sorted);
}

template <class Each>
void eachOf(Particles& p, Each&& each) {
  each(p.positions), each(p.velocities), each(p.densityRatio), each(p.pressure_Pa);
  each(p.state), each(p.s_m), each(p.branch);
}
}  // namespace

void Solver::Impl::sortParticles(std::vector<double>& more) {
  const std::size_t n = active.size();
  // a coating knows particles by their numbers
  if (n < kManyParticles || ++stepsUnsorted < kSortSteps || coating.on()) return;
  stepsUnsorted = 0;
  std::vector<int> order = neighbours.id;
  for (std::size_t p = 0; p < n; ++p)
    if (neighbours.slot[p] < 0) order.push_back(static_cast<int>(p));
  if (number.empty()) {
    number.resize(n);
    for (std::size_t p = 0; p < n; ++p) number[p] = static_cast<int>(p);
  }
  const auto sort = [&](auto& all) { take(all, order); };
  eachOf(particles, sort);
  sort(number), sort(more), sort(active), sort(contacts), sort(gap_m), sort(walls), sort(held);
  sort(contactsAt), sort(lastNearest), sort(projection.densityWarm()), sort(projection.rateWarm());
  sort(viscosity.shear().own_s), sort(viscosity.shear().wall_s);
  sort(viscosity.shear().field);
  sort(shifting.last().shift), sort(shifting.last().push);
  sort(viscosity.drags_ms2()), sort(viscosity.slopes_s());
  if (tension) sort(tension->held()), tension->forgetLists();
  neighbours.renumber();
}

const Particles& Solver::Impl::asNumbered() {
  if (number.empty()) return particles;
  const std::size_t n = number.size();
  if (outside.positions.size() == n) return outside;
  std::vector<int> place(n);
  for (std::size_t p = 0; p < n; ++p) place[number[p]] = static_cast<int>(p);
  outside = particles;
  eachOf(outside, [&](auto& all) { take(all, place); });
  return outside;
}
}  // namespace swallowclip::bolus
