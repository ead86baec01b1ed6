// SPDX-License-Identifier: GPL-2.0-or-later
// A sphere that a knot carries, such as a bullet: its contacts are the cable's.
#pragma once

#include <core/Body.hpp>
#include <pkg/common/Sphere.hpp>

namespace yade {

class CarriedSphere : public Sphere {
public:
    static bool is(const Body& body) {
        return body.shape && body.shape->getClassIndex() == CarriedSphere::getClassIndexStatic();
    }

    // clang-format off
    YADE_CLASS_BASE_DOC_ATTRS_CTOR(CarriedSphere, Sphere,
        "Sphere whose body, or clump, a knot carries. Its contacts are seen before they touch, and solved by the "
        ":yref:`CableEngine` with those of its cables.",
        ,
        createIndex();
    )
    // clang-format on
    REGISTER_CLASS_INDEX(CarriedSphere, Sphere)
};
REGISTER_SERIALIZABLE(CarriedSphere);

} // namespace yade
