// SPDX-License-Identifier: GPL-2.0-or-later
// Forces and torques on bodies, summed over threads by sync().
#pragma once

#include <core/Body.hpp>

#include <mutex>

namespace yade {

class ForceContainer {
    using vvector = vector<Vector3r>;
    vector<vvector> _forceData;
    vector<vvector> _torqueData;
    vector<Body::id_t> _maxId;
    vector<size_t> sizeOfThreads;
    vvector _force;
    vvector _torque;
    vvector _permForce;
    vvector _permTorque;
    size_t size;
    bool syncedSizes;
    int nThreads;
    bool permForceUsed;
    bool permForceSynced;
    std::mutex globalMutex;
    const Vector3r _zero;

public:
    bool synced;
    unsigned long syncCount;
    long lastReset;

    ForceContainer();
    ~ForceContainer();
    void addForce(Body::id_t id, const Vector3r& force);
    void addTorque(Body::id_t id, const Vector3r& torque);
    const Vector3r& getForce(Body::id_t id); // throws unless sync() was called; not inside parallel regions
    const Vector3r& getTorque(Body::id_t id);
    const Vector3r& getPermForce(Body::id_t id);
    const Vector3r& getPermTorque(Body::id_t id);
    bool getPermForceUsed() const;
    int getNumAllocatedThreads() const;
    void addMaxId(Body::id_t id);
    void sync();
    void reset(long iter, bool resetAll = false);
};

} // namespace yade
