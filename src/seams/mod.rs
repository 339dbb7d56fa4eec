//! Partition + SizeWish -> Arrangement in which large sub-domains are cut into parts.
