!> Directions in which a tie does not hold a slave node, because supports hold it there already.
!>
!> The vector row of a tied node is sum share*u = 0, with 1 at the slave node. Along n, where
!> supports hold the slave node, only masters remain: sum of share*(n.u) over those that are free
!> is zero. If all masters but a few hundredths are held as well, as at the end of an interface in a
!> plane of symmetry, that row ties nothing; on faces that are not parallel what remains is the
!> error of the geometry, and it would hold the next master node where it stands. So the multiplier
!> of the slave node has no component there: traces of both sides vanish on the supported boundary,
!> and so does the space of the multiplier (Wohlmuth 2000; Popp, Wohlmuth, Gee, Wall 2012). The row
!> stays where it is exact for linear fields, and where the master has little support of its own.
module lopin_tie_release
   use lopin_kinds, only : wp
   use lopin_dense, only : symmetric_eigen
   use lopin_model, only : model_type
   use lopin_dofs, only : dofs_type
   use lopin_constraints, only : constraints_type
   use lopin_rigid_motion, only : rigid_motion_type, new_rigid_motion
   use lopin_contact_points, only : contact_points_type, sample_type, pair_is_tied
   use lopin_row_samples, only : find_samples
   implicit none
   private
   public :: release_ties, released_directions, row_misfit, held_apart, apart_type

   !> The row goes only if free masters have less than this share of it: else the master needs it.
   real(wp), parameter :: mostly_held = 0.5_wp
   !> Shares below this are rounding: nothing remains of the row.
   real(wp), parameter :: nothing = 1.0e-8_wp
   !> A row that misses linear fields by less, beside its free terms, holds nothing wrongly.
   real(wp), parameter :: exact = 1.0e-3_wp
   !> Squares of coefficients below this, beside the largest, are zero.
   real(wp), parameter :: zero = 1.0e-12_wp

   !> What supports on both sides of a tied point do to it.
   type :: apart_type
      real(wp) :: jump = 0.0_wp            !! largest difference of their displacements [length]
      real(wp) :: moved = 0.0_wp           !! largest displacement of the nodes that it compares
                                           !! [length]
      real(wp) :: place(3) = 0.0_wp        !! mean of the master's held nodes - slave node [length]
      real(wp) :: farthest = 0.0_wp        !! of those nodes [length]
      real(wp) :: share = 0.0_wp           !! of the row that is theirs [-]
      real(wp) :: direction(3) = 0.0_wp
   end type apart_type

contains

   !> Note at all tied points of a scene what supports hold there.
   subroutine release_ties(points, model, dofs, constraints)
      type(contact_points_type), intent(inout) :: points
      type(model_type), intent(in) :: model
      type(dofs_type), intent(in) :: dofs
      type(constraints_type), intent(in) :: constraints
      integer, allocatable :: node(:)
      real(wp), allocatable :: share(:)
      integer :: pair, i, d

      d = model%mesh%ndim
      if (allocated(points%released)) deallocate (points%released, points%axes)
      do pair = 1, size(model%pair)
         if (.not. pair_is_tied(model, model%pair(pair))) cycle
         if (.not. allocated(points%released)) then
            allocate (points%released(points%n), source=0)
            allocate (points%axes(3, 3, points%n), source=0.0_wp)
         end if
         do i = points%first(pair), points%first(pair + 1) - 1
            if (points%facet(i) == 0) cycle
            call terms_of(points, model, i, node, share)
            call released_directions(constraints, dofs, node, share, row_misfit(model%mesh%x, &
               & node, share, points%normal(:d, i)), points%axes(:d, :d, i), points%released(i))
         end do
      end do
   end subroutine release_ties

   !> Nodes of the vector row of a point and their shares, the slave node first; the tool by its
   !> reference.
   subroutine terms_of(points, model, i, node, share)
      type(contact_points_type), intent(in) :: points
      type(model_type), intent(in) :: model
      integer, intent(in) :: i
      integer, allocatable, intent(out) :: node(:)
      real(wp), allocatable, intent(out) :: share(:)
      type(sample_type), allocatable :: sample(:)
      integer :: s, m

      ! Ties have no points inside facets: each place is a node.
      call find_samples(points, i, model%mesh%x, sample)
      node = sample%node(1)
      share = sample%c
      do s = 1, size(sample)
         m = count(points%master(:, sample(s)%point) > 0)
         node = [node, points%master(:m, sample(s)%point)]
         share = [share, -sample(s)%c*points%shape(:m, sample(s)%point)]
      end do
      associate (body => points%body(points%pair(i)))
         if (body == 0) return
         node = [node, model%rigid_body(body)%reference]
         share = [share, -1.0_wp]
      end associate
   end subroutine terms_of

   !> The first `n` columns of `basis` are the directions to leave out; the others span the rest.
   subroutine released_directions(constraints, dofs, node, share, misfit, basis, n)
      type(constraints_type), intent(in) :: constraints
      type(dofs_type), intent(in) :: dofs
      integer, intent(in) :: node(:)           !! the slave's first; a rigid body by its reference
      real(wp), intent(in) :: share(:)         !! of each in the row [-]
      real(wp), intent(in) :: misfit           !! from row_misfit [-]
      real(wp), intent(out) :: basis(:, :)     !! (ndim, ndim) orthonormal
      integer, intent(out) :: n
      real(wp) :: free(size(basis, 1), size(basis, 1)), held(size(basis, 1), size(basis, 1)), &
         & master(size(basis, 1), size(basis, 1)), total
      integer :: k, d, nheld

      n = 0
      d = size(basis, 1)
      basis = unity(d)
      if (is_free(constraints, dofs, node(1), d)) return
      call free_motion(constraints, dofs, node(1), free)
      held = unity(d) - free
      call split(held, 0.5_wp, basis, nheld)
      if (nheld == 0) return
      master = 0.0_wp
      total = 0.0_wp
      do k = 2, size(node)
         if (node(k) == node(1)) cycle
         call free_motion(constraints, dofs, node(k), free)
         master = master + abs(share(k))*free
         total = total + abs(share(k))
      end do
      if (total > 0.0_wp) master = master/total
      call order_by_master(basis, nheld, master, misfit, n)
   end subroutine released_directions

   !> How far supports move a slave node and the held nodes of its master apart.
   subroutine held_apart(points, model, dofs, constraints, i, u, apart)
      type(contact_points_type), intent(in) :: points
      type(model_type), intent(in) :: model
      type(dofs_type), intent(in) :: dofs
      type(constraints_type), intent(in) :: constraints
      integer, intent(in) :: i                 !! point
      real(wp), intent(in) :: u(:)             !! (ndof) displacements with all equations zero
      type(apart_type), intent(out) :: apart
      real(wp) :: free(model%mesh%ndim, model%mesh%ndim), basis(model%mesh%ndim, &
         & model%mesh%ndim), total, held, weight, there, moved, place(model%mesh%ndim), way(3), &
         & own(3), far
      integer, allocatable :: node(:)
      real(wp), allocatable :: share(:)
      integer :: nheld, k, m, d

      d = model%mesh%ndim
      if (is_free(constraints, dofs, points%node(i), d)) return
      call terms_of(points, model, i, node, share)
      call free_motion(constraints, dofs, node(1), free)
      call split(unity(d) - free, 0.5_wp, basis, nheld)
      own = motion_of(model, dofs, u, node(1), model%mesh%x(:, node(1)))
      do m = 1, nheld
         associate (a => basis(:, m))
            total = 0.0_wp
            held = 0.0_wp
            weight = 0.0_wp
            there = 0.0_wp
            far = 0.0_wp
            place = 0.0_wp
            moved = abs(dot_product(a, own(:d)))
            do k = 2, size(node)
               if (node(k) == node(1)) cycle
               total = total + abs(share(k))
               call free_motion(constraints, dofs, node(k), free)
               if (dot_product(a, matmul(free, a)) > nothing) cycle
               way = motion_of(model, dofs, u, node(k), model%mesh%x(:, node(1)))
               held = held + abs(share(k))
               weight = weight - share(k)
               there = there - share(k)*dot_product(a, way(:d))
               moved = max(moved, abs(dot_product(a, way(:d))))
               ! A tool is wherever the node touches it.
               if (dofs%id(6, node(k)) > 0) cycle
               place = place - share(k)*(model%mesh%x(:, node(k)) - model%mesh%x(:, node(1)))
               far = max(far, norm2(model%mesh%x(:, node(k)) - model%mesh%x(:, node(1))))
            end do
            if (.not. weight > mostly_held*held) cycle
            there = abs(there/weight - dot_product(a, own(:d)))
            if (.not. there > apart%jump) cycle
            apart = apart_type(jump=there, moved=moved, farthest=far, share=held/total)
            apart%place(:d) = place/weight
            apart%direction(:d) = a
         end associate
      end do
   end subroutine held_apart

   !> Displacement of a node; of a rigid body, by its reference, that of a place on it.
   pure function motion_of(model, dofs, u, node, x) result(way)
      type(model_type), intent(in) :: model
      type(dofs_type), intent(in) :: dofs
      real(wp), intent(in) :: u(:)
      integer, intent(in) :: node
      real(wp), intent(in) :: x(:)             !! (ndim) [length]
      real(wp) :: way(3), turn(3), turned(3)
      type(rigid_motion_type) :: motion
      integer :: k, d

      d = size(x)
      way = 0.0_wp
      turn = 0.0_wp
      do k = 1, 3
         if (dofs%id(k, node) > 0) way(k) = u(dofs%id(k, node))
         if (dofs%id(k + 3, node) > 0) turn(k) = u(dofs%id(k + 3, node))
      end do
      if (.not. any(abs(turn) > 0.0_wp)) return
      call new_rigid_motion(motion, model%mesh%x(:, node), way(:d), turn(merge(3, 1, d == 2):3))
      turned = 0.0_wp
      turned(:d) = motion%to_global(x) - x
      way = turned
   end function motion_of

   !> Turn the held directions so that those in which the master is held come first.
   subroutine order_by_master(basis, nheld, master, misfit, n)
      real(wp), intent(inout) :: basis(:, :)
      integer, intent(in) :: nheld             !! first columns of the basis
      real(wp), intent(in) :: master(:, :)     !! free share of the masters by direction [-]
      real(wp), intent(in) :: misfit
      integer, intent(out) :: n
      real(wp) :: a(nheld, nheld), value(nheld)
      integer :: status, k

      a = matmul(transpose(basis(:, :nheld)), matmul(master, basis(:, :nheld)))
      call symmetric_eigen(a, value, status)
      n = 0
      if (status /= 0) return
      basis(:, :nheld) = matmul(basis(:, :nheld), a)
      do k = 1, nheld
         if (value(k) > nothing .and. (value(k) >= mostly_held &
            & .or. .not. misfit > exact*value(k))) exit
         n = k
      end do
   end subroutine order_by_master

   !> Error of a row for linear fields along the interface: |sum share*x| over the longest
   !> |x - x_slave|, both across the normal.
   pure real(wp) function row_misfit(x, node, share, normal) result(misfit)
      real(wp), intent(in) :: x(:, :)          !! (ndim, nnode) [length]
      integer, intent(in) :: node(:)           !! the slave's first
      real(wp), intent(in) :: share(:)
      real(wp), intent(in) :: normal(:)        !! (ndim) unit
      real(wp) :: arm(size(x, 1)), total(size(x, 1)), size_
      integer :: k

      total = 0.0_wp
      size_ = 0.0_wp
      do k = 2, size(node)
         arm = x(:, node(k)) - x(:, node(1))
         arm = arm - dot_product(arm, normal)*normal
         total = total + share(k)*arm
         size_ = max(size_, norm2(arm))
      end do
      misfit = 0.0_wp
      if (size_ > 0.0_wp) misfit = norm2(total)/size_
   end function row_misfit

   !> No constraint bears on a node.
   pure logical function is_free(constraints, dofs, node, d)
      type(constraints_type), intent(in) :: constraints
      type(dofs_type), intent(in) :: dofs
      integer, intent(in) :: node, d
      integer :: k

      is_free = constraints%axes_of(node) == 0
      do k = 1, d
         associate (id => dofs%id(k, node))
            is_free = is_free .and. id > 0
            if (is_free) is_free = constraints%rule(id)%prescribed == 0 &
               & .and. .not. constraints%rule(id)%dependent
         end associate
      end do
   end function is_free

   !> Projector on the directions in which free equations move a node; unity if it may turn.
   subroutine free_motion(constraints, dofs, node, projector)
      type(constraints_type), intent(in) :: constraints
      type(dofs_type), intent(in) :: dofs
      integer, intent(in) :: node
      real(wp), intent(out) :: projector(:, :) !! (ndim, ndim)
      real(wp) :: g(size(projector, 1), size(projector, 1)), basis(size(g, 1), size(g, 1))
      integer :: i, j, k, l, d, n

      d = size(projector, 1)
      projector = unity(d)
      if (is_free(constraints, dofs, node, d)) return
      do k = 4, 6
         if (dofs%id(k, node) == 0) cycle
         if (constraints%first(dofs%id(k, node) + 1) > constraints%first(dofs%id(k, node))) return
      end do
      g = 0.0_wp
      do i = 1, d
         do j = 1, d
            if (dofs%id(i, node) == 0 .or. dofs%id(j, node) == 0) cycle
            do k = constraints%first(dofs%id(i, node)), constraints%first(dofs%id(i, node) + 1) - 1
               do l = constraints%first(dofs%id(j, node)), &
                  & constraints%first(dofs%id(j, node) + 1) - 1
                  if (constraints%equation(k) == constraints%equation(l)) g(i, j) = g(i, j) &
                     & + constraints%coefficient(k)*constraints%coefficient(l)
               end do
            end do
         end do
      end do
      call split(g, zero*maxval([(g(i, i), i=1, d)]), basis, n)
      projector = matmul(basis(:, :n), transpose(basis(:, :n)))
   end subroutine free_motion

   !> Eigenvectors of a symmetric matrix, those of the largest values first; `n` are above a bound.
   subroutine split(a, bound, basis, n)
      real(wp), intent(in) :: a(:, :)
      real(wp), intent(in) :: bound
      real(wp), intent(out) :: basis(:, :)
      integer, intent(out) :: n
      real(wp) :: value(size(a, 1)), vector(size(a, 1), size(a, 1))
      integer :: k, status

      vector = a
      call symmetric_eigen(vector, value, status)
      n = 0
      if (status == 0) n = count(value > bound)
      do k = 1, size(value)
         basis(:, k) = vector(:, size(value) + 1 - k)
      end do
   end subroutine split

   pure function unity(d) result(a)
      integer, intent(in) :: d
      real(wp) :: a(d, d)
      integer :: k

      a = 0.0_wp
      do k = 1, d
         a(k, k) = 1.0_wp
      end do
   end function unity
end module lopin_tie_release
