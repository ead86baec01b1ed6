// SPDX-License-Identifier: GPL-2.0-or-later
// Which values contacts were mixed of, so that an edit of a material reaches those that are there.
#pragma once

#include "HollarsMat.hpp"

#include <boost/weak_ptr.hpp>

#include <array>
#include <atomic>
#include <mutex>
#include <unordered_map>
#include <vector>

namespace yade {

class MaterialWatch {
    // young, poisson, and what HollarsMat or FrictMat say of contact
    using Values = std::array<Real, 9>;

    // A material as what it is, so that a step asks for no classes.
    struct View {
        ElastMat* elastic;
        HollarsMat* hollars;
        FrictMat* frict;

        explicit View(Material& material);
        Values values() const;
    };
    struct Known {
        const Material* key;
        boost::weak_ptr<Material> material;
        View view;
        Values values;
    };
    std::mutex mutex;
    std::unordered_map<const Material*, size_t> numbers; // in `known`
    std::vector<Known> known;
    size_t next = 0; // in `known`, to be looked at
    std::atomic<long> editions {1};

public:
    static MaterialWatch& instance();
    void add(const shared_ptr<Material>& material);
    void look();                                     // once a step, before its contacts
    long edition() const { return editions.load(); } // another one after an edit
    void lookAgain() { ++editions; }                 // an edit of what mixes them

    // Of the values of two materials: another one when they are edited, also from one process to the next.
    static long mark(const Material& a, const Material& b);
};

} // namespace yade
