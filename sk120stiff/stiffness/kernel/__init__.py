"""The batch kernel: kinematics, K_C, compliance and principal values of very many poses.

Poses are worked on in blocks. The scratch memory `x` of a block is a flat array that holds one row
of `BLOCK` numbers per scalar of the formulas, one number per pose. Every inner loop runs along
rows, so that the compiler can turn it into SIMD instructions, and nothing is allocated per pose.

`folding` prepares the constants, `motion` moves the joints, `compliance` and `eigen` do the
algebra, `block` puts them together, `compiled` is the door to numba. The public face is
`sk120stiff.stiffness.under_load`.
"""
