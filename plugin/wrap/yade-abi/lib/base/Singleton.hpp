// SPDX-License-Identifier: GPL-2.0-or-later
// The one instance of a class; the libraries hold it and export the function.
#pragma once

template <class T> class Singleton {
public:
    static T& instance();
};
