// SPDX-License-Identifier: GPL-2.0-or-later
// Checks of attributes that come from Python or a file. A refusal is an invalid_argument (ValueError in Python) that
// names object, attribute, number and value, and says what is right.
#pragma once

#include "text.hpp"

#include <lib/base/Math.hpp>

#include <algorithm>
#include <cmath>
#include <stdexcept>

namespace yade {

constexpr Real largestNumber = 1e100; // squares and products of what is below stay finite

inline bool finite(Real value) { return std::abs(value) < largestNumber; }
inline bool finite(const Vector3r& value) { return finite(value[0]) && finite(value[1]) && finite(value[2]); }

class Attributes {
    string object;

    template <class T> static const T& shown(const T& value) { return value; }
    static string shown(const string& value) { return text("'", value, "'"); }
    static string shown(const Vector3r& v) { return text("(", v[0], ", ", v[1], ", ", v[2], ")"); }

public:
    explicit Attributes(string object) : object(std::move(object)) {}

    template <class... Parts> [[noreturn]] void refuse(const Parts&... parts) const {
        throw std::invalid_argument(text(object, ": ", parts...));
    }

    template <class T> void need(bool good, const char* name, const T& value, const string& rule) const {
        if (!good) refuse(name, " = ", shown(value), ": must be ", rule);
    }

    template <class T> void size(const char* name, const vector<T>& list, size_t right, const string& why) const {
        if (list.size() != right) refuse(name, " has ", list.size(), " values: must have ", right, ", ", why);
    }

    template <class List, class Good>
    void each(const char* name, const List& list, const string& rule, Good good) const {
        for (size_t i = 0; i < list.size(); ++i)
            if (!good(list[i])) refuse(name, "[", i, "] = ", shown(list[i]), ": must be ", rule);
    }

    // The whole numbers from `least` to below `end`, which are the numbers of something.
    template <class List>
    void within(const char* name, const List& list, int least, int end, const string& what) const {
        each(name, list, text(what, ", ", least, " to ", end - 1),
             [&](int value) { return value >= least && value < end; });
    }

    template <class List> void finiteEach(const char* name, const List& list) const {
        each(name, list, "finite, and below 1e100", [](const auto& value) { return finite(value); });
    }

    template <class List> void notNegative(const char* name, const List& list) const {
        each(name, list, "finite and not below 0", [](Real value) { return finite(value) && value >= 0; });
    }

    void distinct(const char* name, vector<int> list, const char* why) const {
        std::sort(list.begin(), list.end());
        const auto twice = std::adjacent_find(list.begin(), list.end());
        if (twice != list.end()) refuse(name, " holds ", *twice, " twice: ", why);
    }
};

} // namespace yade
