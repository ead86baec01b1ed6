// SPDX-License-Identifier: GPL-2.0-or-later
// All bodies of a scene; erased ones leave an empty pointer behind.
#pragma once

#include <core/Body.hpp>

#include <boost/iterator/filter_iterator.hpp>

#include <mutex>

namespace yade {

class BodyContainer : public Serializable {
    friend class InteractionContainer;
    using ContainerT = vector<shared_ptr<Body>>;
    struct isNonEmptySharedPtr {
        bool operator()(const shared_ptr<Body>& b) const { return static_cast<bool>(b); }
    };
    ContainerT body;

public:
    using iterator = boost::filter_iterator<isNonEmptySharedPtr, ContainerT::iterator>;

    bool dirty;
    bool checkedByCollider;
    vector<Body::id_t> insertedBodies;
    vector<Body::id_t> erasedBodies;
    vector<Body::id_t> realBodies;
    bool useRedirection;
    bool enableRedirection;
    vector<Body::id_t> subdomainBodies;
    std::mutex drawloopmutex;

    Body::id_t insert(shared_ptr<Body>);
    bool erase(Body::id_t id, bool eraseClumpMembers); // take Python's lock around it
    bool exists(Body::id_t id) const;
    size_t size() const;
    shared_ptr<Body>& operator[](unsigned id);
    const shared_ptr<Body>& operator[](unsigned id) const;
    iterator begin();
    iterator end();
    void clear();
    void updateRealBodies();
    ANCF_PACKAGED(BodyContainer)
};

} // namespace yade
ANCF_PACKAGED_REGISTERED(BodyContainer)
