/* Variances that a state's errors give to what is read off it; see spread.c. Symmetric matrices have no order. */
#ifndef MBKF_SPREAD_H
#define MBKF_SPREAD_H

/* Errors of a state (q, v, a, rest) of N components as mbkf/filters/error_covariance.py states them:
 * S P S + skin's part by W' W, the inverse of one frame's information on the seen dofs, + rows' rows. */
typedef struct {
    int N, nv;
    const double *P, *information; /* (N x N), (nv x nv) */
    int n_seen;
    const int *seen;     /* dofs that markers observe */
    const double *size;  /* (N) diagonal of S */
    double skin, rate;   /* variance of the markers' skin, and how fast it moves */
    int n_rows;
    const double *rows;  /* (n_rows x N), row by row */
} Errors;

/* diagonal: (N) of the errors' covariance. root: (n_seen x nv) W, column by column, 0 in columns that are not seen.
 * Returns 0, or 1 where the information cannot be factorised. work: root_work(nv) numbers. */
int error_diagonal(const Errors *e, double *root, double *diagonal, double *work);
long root_work(int nv);

/* variance: (m) of quantities T (m x n, column by column) of the first n components. */
void error_of(const Errors *e, const double *root, int m, int n, const double *T, double *variance, double *work);
long error_work(int m, int n, int nv);

/* blocks: (n_blocks x 3 x 3) of the errors' covariance, of three components of q each, from `first` on. */
void error_blocks(const Errors *e, const double *root, int n_blocks, const int *first, double *blocks);

#endif
