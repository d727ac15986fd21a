!> A part of the bodies near some contact points, cut out of the stiffness of the run: the forces
!> with which the points close where loads on the bodies would open them.
!>
!> Farther nodes are held. A point is a stiff spring, so that the matrix is positive definite.
module lopin_contact_patch
   use lopin_kinds, only : wp
   use lopin_constraints, only : constraints_type, reduce
   use lopin_csc, only : csc_type, storage
   use lopin_csc_sum, only : sum_of
   use lopin_error, only : error_type
   use lopin_linear_solver, only : linear_solver_type, matrix_class
   use lopin_model, only : model_type
   use lopin_reduce_matrix, only : reduce_matrix
   use lopin_scene, only : scene_type
   use lopin_solver_factory, only : new_solver, choose_solver
   implicit none
   private
   public :: patch_type, new_patch, solve_patch

   !> How far from the contact nodes move, in edges of its facets: what alternates from facet to
   !> facet fades within one. In space each costs: the factor grows with the third power of nodes.
   real(wp), parameter :: deep = 4.0_wp, deep_in_space = 2.0_wp
   !> Springs of the points, and of motions that nothing holds, beside the stiffness.
   real(wp), parameter :: stiff = 1.0e4_wp, soft = 1.0e-8_wp

   !> Gaps in the displacements of a patch: that of point r has the entries first(r) to
   !> first(r+1) - 1.
   type :: patch_type
      integer, allocatable :: number(:)        !! (neq) equation of the patch; 0: held
      integer, allocatable :: first(:)         !! (points + 1)
      integer, allocatable :: equation(:)
      real(wp), allocatable :: coefficient(:)  !! of the gap
      integer, allocatable :: point(:)         !! of the scene
   end type patch_type

contains

   subroutine new_patch(self, scene, model, constraints, point, node)
      type(patch_type), intent(out) :: self
      type(scene_type), intent(in) :: scene
      type(model_type), intent(in) :: model
      type(constraints_type), intent(in) :: constraints
      integer, intent(in) :: point(:)          !! of the scene
      integer, intent(in) :: node(:)           !! mesh nodes of both surfaces
      real(wp) :: away(model%mesh%nnode)
      integer :: i, k, n

      self%point = point
      away = huge(1.0_wp)
      away(node) = 0.0_wp
      call go_inside(model, merge(deep, deep_in_space, model%mesh%ndim == 2)* &
         & maxval(scene%points%size(point)), away)
      allocate (self%number(constraints%neq), source=0)
      do i = 1, scene%dofs%n
         if (scene%dofs%dof(i) > model%mesh%ndim) cycle
         if (.not. away(scene%dofs%node(i)) < huge(1.0_wp)) cycle
         do k = constraints%first(i), constraints%first(i + 1) - 1
            self%number(constraints%equation(k)) = 1
         end do
      end do
      n = 0
      do i = 1, constraints%neq
         if (self%number(i) == 0) cycle
         n = n + 1
         self%number(i) = n
      end do
      call list_rows(self, scene, constraints)
   end subroutine new_patch

   !> Distances from the nodes at 0 along edges and diagonals of elements, as far as `reach` and one
   !> node beyond.
   pure subroutine go_inside(model, reach, away)
      type(model_type), intent(in) :: model
      real(wp), intent(in) :: reach                !! [length]
      real(wp), intent(inout) :: away(:)           !! (mesh nodes); huge: not reached [length]
      logical :: changed
      integer :: e, i, n

      do
         changed = .false.
         do e = 1, model%mesh%nelement
            n = count(model%mesh%conn(:, e) > 0)
            associate (node => model%mesh%conn(:n, e))
               if (.not. minval(away(node)) <= reach) cycle
               do i = 1, n
                  if (away(node(i)) <= reach) call go_on(node, node(i), away, changed)
               end do
            end associate
         end do
         if (.not. changed) return
      end do

   contains

      !> From one node of an element to the others.
      pure subroutine go_on(node, from, away, changed)
         integer, intent(in) :: node(:), from
         real(wp), intent(inout) :: away(:)
         logical, intent(inout) :: changed
         real(wp) :: new
         integer :: k

         do k = 1, size(node)
            new = away(from) + norm2(model%mesh%x(:, node(k)) - model%mesh%x(:, from))
            if (.not. new < away(node(k))) cycle
            changed = .true.
            away(node(k)) = new
         end do
      end subroutine go_on
   end subroutine go_inside

   !> The gap of each point in the equations of the patch; one may stand in several entries.
   subroutine list_rows(self, scene, constraints)
      type(patch_type), intent(inout) :: self
      type(scene_type), intent(in) :: scene
      type(constraints_type), intent(in) :: constraints
      integer :: i, j, m

      allocate (self%first(size(self%point) + 1), self%equation(0), self%coefficient(0))
      do i = 1, size(self%point)
         self%first(i) = size(self%equation) + 1
         associate (points => scene%points, p => self%point(i))
            call add(points%node(p), points%normal(:, p))
            m = count(points%master(:, p) > 0)
            do j = 1, m
               call add(points%master(j, p), -points%shape(j, p)*points%normal(:, p))
            end do
         end associate
      end do
      self%first(size(self%point) + 1) = size(self%equation) + 1

   contains

      subroutine add(node, way)
         integer, intent(in) :: node
         real(wp), intent(in) :: way(:)
         integer :: d, k, dof

         do d = 1, 3
            dof = scene%dofs%id(d, node)
            if (dof == 0 .or. .not. abs(way(d)) > 0.0_wp) cycle
            do k = constraints%first(dof), constraints%first(dof + 1) - 1
               if (self%number(constraints%equation(k)) == 0) cycle
               self%equation = [self%equation, self%number(constraints%equation(k))]
               self%coefficient = [self%coefficient, constraints%coefficient(k)*way(d)]
            end do
         end do
      end subroutine add
   end subroutine list_rows

   !> Under loads on the nodes and `push` at each point: what the points push more. Not allocated if
   !> that cannot be found.
   subroutine solve_patch(self, scene, constraints, push, load, more)
      type(patch_type), intent(in) :: self
      type(scene_type), intent(in) :: scene
      type(constraints_type), intent(in) :: constraints
      real(wp), intent(in) :: push(:)              !! (points)
      real(wp), intent(in) :: load(:, :)           !! (ndim, mesh nodes)
      real(wp), allocatable, intent(out) :: more(:)   !! (points)
      type(csc_type) :: k, springs, both
      class(linear_solver_type), allocatable :: solver
      type(error_type), allocatable :: error
      character(len=:), allocatable :: name, reason
      real(wp), allocatable :: u(:, :)
      real(wp) :: spring
      integer :: i, bad

      if (.not. any(self%number > 0)) return
      call reduce_matrix(scene%k, constraints, self%number, maxval(self%number), k)
      call add_springs(self, k, springs, spring)
      call sum_of(k, springs, both)
      call choose_solver(both, matrix_class%positive_definite, [integer ::], name, reason)
      call new_solver(solver, name, error)
      if (.not. allocated(error)) call solver%analyse(both, matrix_class%positive_definite, &
         & [integer ::], error)
      if (.not. allocated(error)) call solver%factorise(both, bad, error)
      if (allocated(error)) return
      call find_loads(self, scene, constraints, push, load, u)
      call solver%solve(u)
      allocate (more(size(self%point)))
      do i = 1, size(self%point)
         associate (part => [(bad, bad=self%first(i), self%first(i + 1) - 1)])
            more(i) = -spring*sum(self%coefficient(part)*u(self%equation(part), 1))
         end associate
      end do
   end subroutine solve_patch

   subroutine add_springs(self, k, springs, spring)
      type(patch_type), intent(in) :: self
      type(csc_type), intent(in) :: k
      type(csc_type), intent(out) :: springs
      real(wp), intent(out) :: spring
      real(wp) :: own(k%n)
      real(wp), allocatable :: value(:)
      integer, allocatable :: i(:), j(:)
      integer :: n, r, a, b

      call k%diagonal(own)
      spring = stiff*maxval(own)
      n = k%n + sum((self%first(2:) - self%first(:size(self%point)))**2)
      allocate (i(n), j(n), source=1)
      allocate (value(n), source=0.0_wp)
      i(:k%n) = [(a, a=1, k%n)]
      j(:k%n) = i(:k%n)
      value(:k%n) = soft*own
      n = k%n
      do r = 1, size(self%point)
         do a = self%first(r), self%first(r + 1) - 1
            do b = self%first(r), self%first(r + 1) - 1
               ! Each pair once: new_from_triplets mirrors what lies above the diagonal.
               if (self%equation(a) < self%equation(b)) cycle
               n = n + 1
               i(n) = self%equation(a)
               j(n) = self%equation(b)
               value(n) = spring*self%coefficient(a)*self%coefficient(b)
            end do
         end do
      end do
      call springs%new_from_triplets(k%n, storage%symmetric_lower, i(:n), j(:n), value(:n))
   end subroutine add_springs

   subroutine find_loads(self, scene, constraints, push, load, f)
      type(patch_type), intent(in) :: self
      type(scene_type), intent(in) :: scene
      type(constraints_type), intent(in) :: constraints
      real(wp), intent(in) :: push(:), load(:, :)
      real(wp), allocatable, intent(out) :: f(:, :)    !! (equations, 1)
      real(wp) :: on_dof(scene%dofs%n), free(constraints%neq)
      integer :: i, d, k

      on_dof = 0.0_wp
      do i = 1, size(load, 2)
         do d = 1, size(load, 1)
            if (scene%dofs%id(d, i) > 0) on_dof(scene%dofs%id(d, i)) = load(d, i)
         end do
      end do
      call reduce(constraints, on_dof, free)
      allocate (f(maxval(self%number), 1))
      do i = 1, constraints%neq
         if (self%number(i) > 0) f(self%number(i), 1) = free(i)
      end do
      do i = 1, size(self%point)
         do k = self%first(i), self%first(i + 1) - 1
            f(self%equation(k), 1) = f(self%equation(k), 1) + push(i)*self%coefficient(k)
         end do
      end do
   end subroutine find_loads
end module lopin_contact_patch
