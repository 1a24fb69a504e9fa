/* Forgets the instruction set before, so that a body can be compiled for the next one. */
#undef NAME
#undef TARGET
#undef VECTOR
#undef FUNNEL
#undef SLIDE
#undef ANY
#undef IS_ZERO
#undef TERNARY
#undef XOR3
#undef MAJORITY
#undef VEC
#undef LANES
