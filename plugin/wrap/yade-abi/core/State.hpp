// SPDX-License-Identifier: GPL-2.0-or-later
// Position and motion of a body.
#pragma once

#include <lib/multimethods/Indexable.hpp>
#include <lib/serialization/Serializable.hpp>

#include <mutex>

namespace yade {

class State : public Serializable, public Indexable {
public:
    Vector3r& pos;
    Quaternionr& ori;
    std::mutex updateMutex;
    Se3r se3;
    Vector3r vel;
    Real mass;
    Vector3r angVel;
    Vector3r angMom;
    Vector3r inertia;
    Vector3r refPos;
    Quaternionr refOri;
    unsigned blockedDOFs;
    bool isDamped;
    Real densityScaling;

    enum { DOF_NONE = 0, DOF_X = 1, DOF_Y = 2, DOF_Z = 4, DOF_RX = 8, DOF_RY = 16, DOF_RZ = 32 };
    static constexpr unsigned DOF_XYZ = DOF_X | DOF_Y | DOF_Z;
    static constexpr unsigned DOF_RXRYRZ = DOF_RX | DOF_RY | DOF_RZ;
    static constexpr unsigned DOF_ALL = DOF_XYZ | DOF_RXRYRZ;

    State();
    std::string blockedDOFs_vec_get() const;
    void blockedDOFs_vec_set(const std::string& letters);
    ANCF_PACKAGED(State)
    ANCF_PACKAGED_INDEX_ROOT
};

} // namespace yade
ANCF_PACKAGED_REGISTERED(State)
