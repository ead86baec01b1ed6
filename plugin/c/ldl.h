// Sparse symmetric positive definite matrices of 3x3 blocks, factored as L D L^T in place: the structure once, the
// numbers in every step without allocation.
#ifndef ANCF_LDL_H
#define ANCF_LDL_H

#include "ancf/error.h"
#include <stdbool.h>

// A block by columns, each one vector register with a fourth entry that is not used.
typedef double ancf_column __attribute__((vector_size(4 * sizeof(double)), aligned(sizeof(double))));
typedef ancf_column ancf_block[3];

typedef struct ancf_ldl {
    int n;              // rows and columns of blocks
    int *begin, *index; // (n + 1), (begin[n]) blocks of each column, the diagonal one first, rows ascending
    int* row;           // (n) of the matrix for an unknown: the order that keeps L sparse
    ancf_block* value;  // (begin[n]) of the matrix, then of L and, on the diagonal, of D^-1
    ancf_block* column; // (longest column) scratch
    ancf_column* rhs;   // (n) right-hand side and solution by rows
} ancf_ldl;

// For n unknowns, pair: (n_pairs x 2) those that share a block off the diagonal, repeated ones allowed.
ancf_error ancf_ldl_create(ancf_ldl** ldl, int n, const int* pair, int n_pairs);
void ancf_ldl_destroy(ancf_ldl* ldl);

// Number in `value` of the block of two rows of the matrix, row >= column, both as ancf_ldl.row gives them.
int ancf_ldl_place(const ancf_ldl* ldl, int row, int column);

// False if the matrix is not positive definite; its values are then lost.
bool ancf_ldl_factor(ancf_ldl* ldl);

// rhs = A^-1 rhs.
void ancf_ldl_solve(ancf_ldl* ldl);

#endif
