// SPDX-License-Identifier: GPL-2.0-or-later
// Sums with one slot per thread, as they lie in memory in EnergyTracker.
#pragma once

#include <lib/base/Math.hpp>

#include <omp.h>

namespace yade {

template <class T> class OpenMPArrayAccumulator {
    int cacheLine_;
    size_t threads_;
    int perLine_;
    std::vector<T*> parts_; // one array of size_ values per thread
    size_t size_;
    size_t lines_;

public:
    size_t size() const { return size_; }
    T get(size_t i) const {
        T sum {};
        for (T* part : parts_) sum += part[i];
        return sum;
    }
    void add(size_t i, const T& value) { parts_[static_cast<size_t>(omp_get_thread_num())][i] += value; }
    void set(size_t i, const T& value) {
        for (T* part : parts_) part[i] = T {};
        parts_[0][i] = value;
    }
};

} // namespace yade
