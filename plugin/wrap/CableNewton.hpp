// SPDX-License-Identifier: GPL-2.0-or-later
// NewtonIntegrator that leaves the elements of cables to their engine.
#pragma once

#include <core/Scene.hpp>
#include <pkg/dem/NewtonIntegrator.hpp>

namespace yade {

class CableNewton : public NewtonIntegrator {
    vector<Body::id_t> seen, moved; // all bodies, and those that are no elements

    void list();

public:
    void action() override;

    // clang-format off
    YADE_CLASS_BASE_DOC(CableNewton, NewtonIntegrator,
        "A :yref:`NewtonIntegrator` that does not visit the bodies of cable elements, which only their "
        ":yref:`CableEngine` moves. With YADE's own all works as well, at 30 ns for each of them in every step.")
    // clang-format on
};
REGISTER_SERIALIZABLE(CableNewton);

} // namespace yade
