"""What `make generate` wrote: C, header, CasADi's serialised functions. Do not edit."""
