/* BLAS and LAPACK of SciPy, which choose their instructions at run time. Matrices are column by column. */
#ifndef MBKF_BLAS_H
#define MBKF_BLAS_H

typedef struct {
    void (*dgemm)(char *, char *, int *, int *, int *, double *, double *, int *, double *, int *, double *,
                  double *, int *);
    void (*dsyrk)(char *, char *, int *, int *, double *, double *, int *, double *, double *, int *);
    void (*dtrsm)(char *, char *, char *, char *, int *, int *, double *, double *, int *, double *, int *);
    void (*dpotrf)(char *, int *, double *, int *, int *);
} Blas;

extern Blas blas; /* filled once, when the module is loaded (module.c) */

#endif
