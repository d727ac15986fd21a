!> Matrices for the tests and the benchmark of the linear solvers.
module matrices
   use lopin_kinds, only : wp
   use lopin_csc, only : csc_type, storage
   implicit none
   private
   public :: elastic_block, random_spd, random_general, saddle_point, uniform, to_csc, chain

contains

   !> Stiffness of a block of unit bilinear or trilinear elements, E = 1, nu = 0.3 (2D: plane
   !> strain).
   !>
   !> With `clamped` the face x = 0 is held; else the block is free and the matrix is singular.
   !> `top`: the face where the last coordinate is largest.
   subroutine elastic_block(cells, clamped, a, top)
      integer, intent(in) :: cells(:)               !! (ndim) elements along each direction
      logical, intent(in) :: clamped
      type(csc_type), intent(out) :: a
      integer, allocatable, intent(out) :: top(:)   !! equations of the top face
      integer, allocatable :: number(:, :), ptr(:), list(:), element(:)
      real(wp), allocatable :: ke(:, :)
      integer, allocatable :: slots(:, :)
      integer :: ndim, node, nnode, nelem, e, i, c, n, at(3), m
      integer :: nodes(3), cell(3)

      ndim = size(cells)
      cell = 1
      cell(:ndim) = cells
      nodes = 1
      nodes(:ndim) = cells + 1
      nnode = product(nodes)
      nelem = product(cells)
      allocate (number(ndim, nnode), top(0))
      n = 0
      do node = 1, nnode
         do c = 1, ndim
            number(c, node) = 0
            if (clamped .and. mod(node - 1, nodes(1)) == 0) cycle
            n = n + 1
            number(c, node) = n
         end do
      end do
      node = nnode - nnode/nodes(ndim)
      top = pack(reshape(number(:, node + 1:), [ndim*(nnode - node)]), &
         & reshape(number(:, node + 1:), [ndim*(nnode - node)]) > 0)
      m = ndim*2**ndim
      allocate (ptr(nelem + 1), list(m*nelem), element(m), ke(m, m), slots(m, m))
      do e = 1, nelem
         at = [mod(e - 1, cell(1)), mod((e - 1)/cell(1), cell(2)), (e - 1)/(cell(1)*cell(2))]
         do i = 0, 2**ndim - 1
            node = 1 + at(1) + ibits(i, 0, 1) + nodes(1)*(at(2) + ibits(i, 1, 1) &
               & + nodes(2)*(at(3) + ibits(i, 2, 1)))
            list(m*(e - 1) + ndim*i + 1:m*(e - 1) + ndim*(i + 1)) = number(:, node)
         end do
         ptr(e) = m*(e - 1) + 1
      end do
      ptr(nelem + 1) = m*nelem + 1
      call a%new_from_lists(n, storage%symmetric_lower, ptr, list)
      call element_stiffness(ndim, ke)
      do e = 1, nelem
         call a%element_slots(list(ptr(e):ptr(e + 1) - 1), slots)
         call a%add_block(slots, ke)
      end do
   end subroutine elastic_block

   subroutine element_stiffness(ndim, ke)
      integer, intent(in) :: ndim
      real(wp), intent(out) :: ke(:, :)
      real(wp), parameter :: lambda = 0.3_wp/(1.3_wp*0.4_wp), mu = 1.0_wp/2.6_wp
      real(wp) :: g(3, 8), x(3), f
      integer :: q, i, j, c, d, k

      ke = 0.0_wp
      do q = 0, 2**ndim - 1
         x = 0.5_wp + (real([ibits(q, 0, 1), ibits(q, 1, 1), ibits(q, 2, 1)], &
            & wp) - 0.5_wp)/sqrt(3.0_wp)
         do i = 0, 2**ndim - 1
            do c = 1, ndim
               f = 1.0_wp
               do k = 1, ndim
                  if (k == c) then
                     f = f*real(2*ibits(i, k - 1, 1) - 1, wp)
                  else
                     f = f*merge(x(k), 1.0_wp - x(k), btest(i, k - 1))
                  end if
               end do
               g(c, i + 1) = f
            end do
         end do
         do j = 1, 2**ndim
            do i = 1, 2**ndim
               do d = 1, ndim
                  do c = 1, ndim
                     f = lambda*g(c, i)*g(d, j) + mu*g(d, i)*g(c, j)
                     if (c == d) f = f + mu*dot_product(g(:ndim, i), g(:ndim, j))
                     k = ndim*(j - 1) + d
                     ke(ndim*(i - 1) + c, k) = ke(ndim*(i - 1) + c, k) + f/2.0_wp**ndim
                  end do
               end do
            end do
         end do
      end do
   end subroutine element_stiffness

   !> Diagonally dominant symmetric matrix with about `degree` entries a row at random places.
   subroutine random_spd(n, degree, seed, a)
      integer, intent(in) :: n, degree
      integer, intent(inout) :: seed
      type(csc_type), intent(out) :: a
      real(wp) :: dense(n, n), v
      integer :: i, j, k

      dense = 0.0_wp
      do i = 1, n
         dense(i, i) = dense(i, i) + 0.1_wp + uniform(seed)
         do k = 1, degree/2
            j = 1 + int(uniform(seed)*n)
            if (j == i) cycle
            v = uniform(seed) - 0.5_wp
            dense(i, j) = dense(i, j) + v
            dense(j, i) = dense(j, i) + v
            dense(i, i) = dense(i, i) + abs(v)
            dense(j, j) = dense(j, j) + abs(v)
         end do
      end do
      call to_csc(dense, storage%symmetric_lower, a)
   end subroutine random_spd

   !> Well-conditioned matrix without symmetry.
   subroutine random_general(n, degree, seed, a)
      integer, intent(in) :: n, degree
      integer, intent(inout) :: seed
      type(csc_type), intent(out) :: a
      real(wp) :: dense(n, n)
      integer :: i, j, k

      dense = 0.0_wp
      do i = 1, n
         do k = 1, degree
            j = 1 + int(uniform(seed)*n)
            dense(i, j) = uniform(seed) - 0.5_wp
         end do
         dense(i, i) = dense(i, i) + 1.0_wp + uniform(seed)*degree
      end do
      call to_csc(dense, storage%general, a)
   end subroutine random_general

   !> [K G; G' 0] with m random constraints on the equations of `on`, multipliers last.
   subroutine saddle_point(k, on, m, seed, a)
      type(csc_type), intent(in) :: k
      integer, intent(in) :: on(:), m
      integer, intent(inout) :: seed
      type(csc_type), intent(out) :: a
      real(wp) :: dense(k%n + m, k%n + m), all_of(k%n, k%n), v
      integer :: i, j, l

      dense = 0.0_wp
      call k%to_dense(all_of)
      dense(:k%n, :k%n) = all_of
      do i = 1, m
         do l = 1, 3
            j = on(1 + mod(2*i + l, size(on)))
            v = 1.0_wp/l + 0.1_wp*uniform(seed)
            dense(j, k%n + i) = v
            dense(k%n + i, j) = v
         end do
      end do
      call to_csc(dense, storage%symmetric_lower, a)
   end subroutine saddle_point

   !> n unit springs in a row, the first one fixed, a penalty at the tip.
   subroutine chain(n, penalty, a)
      integer, intent(in) :: n
      real(wp), intent(in) :: penalty
      type(csc_type), intent(out) :: a
      integer :: i

      call a%new_from_triplets(n, storage%symmetric_lower, [(i, i=1, n), (i + 1, i=1, n - 1)], &
         & [(i, i=1, n), (i, i=1, n - 1)], [(merge(2.0_wp, 1.0_wp + penalty, i < n), i=1, n), &
         & (-1.0_wp, i=1, n - 1)])
   end subroutine chain

   subroutine to_csc(dense, kind, a)
      real(wp), intent(in) :: dense(:, :)
      integer, intent(in) :: kind
      type(csc_type), intent(out) :: a
      integer :: i, j, n, m
      integer, allocatable :: rows(:), columns(:)
      real(wp), allocatable :: values(:)

      n = size(dense, 1)
      allocate (rows(n*n), columns(n*n), values(n*n))
      m = 0
      do j = 1, n
         do i = merge(j, 1, kind == storage%symmetric_lower), n
            if (abs(dense(i, j)) <= 0.0_wp) cycle
            m = m + 1
            rows(m) = i
            columns(m) = j
            values(m) = dense(i, j)
         end do
      end do
      call a%new_from_triplets(n, kind, rows(:m), columns(:m), values(:m))
   end subroutine to_csc

   !> The next number in [0, 1) of a small generator, the same on every machine.
   real(wp) function uniform(seed)
      integer, intent(inout) :: seed
      seed = mod(16807*mod(seed, 127773) - 2836*(seed/127773), 2147483647)
      if (seed < 0) seed = seed + 2147483647
      uniform = real(seed, wp)/2147483648.0_wp
   end function uniform
end module matrices
