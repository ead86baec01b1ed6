// SPDX-License-Identifier: GPL-2.0-or-later
// Nodes and places of a model as vectors of YADE, and the bodies they belong to.
#pragma once

#include "text.hpp"

#include <core/Scene.hpp>

#include <algorithm>

extern "C" {
#include "ancf/model.h"
}

namespace yade {

inline Vector3r placeOf(const ancf_model* m, const Real* field, int element, Real xi) {
    Real value[3];
    ancf_model_at(value, m, field, element, xi);
    return Vector3r(value[0], value[1], value[2]);
}

// Mean over several places, from the means of their xi, xi^2 and xi^3.
inline Vector3r meanOf(const ancf_model* m, const Real* field, int element, const Vector3r& power) {
    Real value[3];
    ancf_model_mean_at(value, m, field, element, power.data());
    return Vector3r(value[0], value[1], value[2]);
}

inline Vector3r nodeOf(const Real* field, int stride, int node) {
    return Vector3r(field[node], field[stride + node], field[2 * stride + node]);
}

inline void setNode(Real* field, int stride, int node, const Vector3r& value) {
    for (int c = 0; c < 3; ++c) field[c * stride + node] = value[c];
}

inline void addNode(Real* field, int stride, int node, const Vector3r& value) {
    for (int c = 0; c < 3; ++c) field[c * stride + node] += value[c];
}

inline const Body& bodyOf(const Scene& s, Body::id_t id, const char* what) {
    if (!s.bodies->exists(id))
        throw std::invalid_argument(text("CableEngine.", what, ": body ", id, " does not exist"));
    return *(*s.bodies)[id];
}

template <class T> bool has(const vector<T>& values, const T& value) {
    return std::find(values.begin(), values.end(), value) != values.end();
}

} // namespace yade
