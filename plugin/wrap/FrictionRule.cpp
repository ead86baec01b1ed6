// SPDX-License-Identifier: GPL-2.0-or-later
#include "FrictionRule.hpp"

#include "Attributes.hpp"
#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>
#include <stdexcept>

namespace yade {

namespace {
    constexpr std::array<const char*, 3> names = {"min", "max", "mean"};
} // namespace

Real FrictionRule::mix(Real a, Real b) const {
    if (std::isinf(a)) return std::isinf(b) ? 0 : b;
    if (std::isinf(b)) return a;
    return kind == MIN ? std::min(a, b) : kind == MAX ? std::max(a, b) : (a + b) / 2;
}

const Real* FrictionRule::own(const Material& a, const Material& b) const {
    for (size_t i = 0; pairs && 2 * i + 1 < pairs->size(); ++i) {
        const int p = (*pairs)[2 * i], q = (*pairs)[2 * i + 1];
        if ((p == a.id && q == b.id) || (p == b.id && q == a.id)) return &(*friction)[2 * i];
    }
    return nullptr;
}

long FrictionRule::mark(long ofMaterials, const Material& a, const Material& b) const {
    std::array<uint64_t, 3> words = {static_cast<uint64_t>(kind), 0, 0};
    if (const Real* pair = own(a, b)) {
        std::memcpy(&words[1], pair, 2 * sizeof *pair);
        words[0] = 3;
    }
    auto hash = static_cast<uint64_t>(ofMaterials);
    for (const uint64_t word : words) {
        hash = (hash ^ word) * 1099511628211u; // FNV-1a, by words
        hash ^= hash >> 32;
    }
    return static_cast<long>(hash >> 1); // never negative
}

FrictionRule checkedRule(const string& functor, const string& rule, const vector<int>& pairs,
                         const vector<Real>& friction) {
    const auto found = std::find(names.begin(), names.end(), rule);
    if (found == names.end())
        throw std::invalid_argument(text(functor, ".frictionRule = '", rule, "': must be 'min', 'max' or 'mean'"));
    if (pairs.size() % 2 || pairs.size() != friction.size())
        throw std::invalid_argument(text(functor, ".frictionPairs has ", pairs.size(), " ids and pairFriction ",
                                         friction.size(), " coefficients: must be two of each for a pair"));
    for (const int id : pairs)
        if (id < 0)
            throw std::invalid_argument(text(functor, ".frictionPairs holds ", id, ": must be ids of materials"));
    for (const Real value : friction)
        if (!(finite(value) && value >= 0))
            throw std::invalid_argument(
                text(functor, ".pairFriction holds ", value, ": must be finite, below 1e100 and not below 0"));
    return {static_cast<FrictionRule::Kind>(found - names.begin()), &pairs, &friction};
}

void setPairFriction(vector<int>& pairs, vector<Real>& friction, const string& functor, int first, int second,
                     Real staticFriction, Real kineticFriction) {
    checkedRule(functor + ".setFriction", "min", {first, second}, {staticFriction, kineticFriction});
    for (size_t i = 0; 2 * i + 1 < pairs.size(); ++i)
        if (std::minmax(pairs[2 * i], pairs[2 * i + 1]) == std::minmax(first, second)) {
            friction[2 * i] = staticFriction;
            friction[2 * i + 1] = kineticFriction;
            return;
        }
    pairs.insert(pairs.end(), {first, second});
    friction.insert(friction.end(), {staticFriction, kineticFriction});
}

} // namespace yade
