!> Slopes of the stresses of module surface_stress in the displacements around.
!>
!> They are those of consistent tangents of the points; where an element finds internal modes or a
!> thickness by iterations of its own, they are differences of one element at a time.
module lopin_surface_slopes
   use lopin_kinds, only : wp
   use lopin_element_type, only : element_type
   use lopin_element_input, only : element_input_type
   use lopin_solids, only : unit_nodes
   use lopin_simplex_patches, only : patch_element
   use lopin_solid_configuration, only : configuration_type, columns
   use lopin_material_memory, only : stress_at, strain_at
   use lopin_point_slopes, only : has_point_slopes, finite_strain_slopes
   use lopin_solid_flow, only : has_flow_slopes, flow_slopes
   use lopin_surface_stress, only : surface_stress_type, share_type, compute, read_unit, &
      & remembers, members_of
   use lopin_von_mises, only : von_mises_slope
   implicit none
   private
   public :: slopes_type, find_slopes

   !> A displacement of one dof, beside the size of its element.
   real(wp), parameter :: step = 1.0e-7_wp

   !> Slopes of both stresses of a node by dofs.
   type :: slopes_type
      integer :: n = 0
      integer, allocatable :: dof(:)
      real(wp), allocatable :: mises(:), flow(:)   !! [stress/length]
   end type slopes_type

contains

   !> Slopes at some of the nodes of the stresses that `find_stress` has found at the same
   !> displacements.
   subroutine find_slopes(self, shape, u, wanted, reads, slopes)
      type(surface_stress_type), intent(inout) :: self
      type(configuration_type), intent(in) :: shape      !! displaced by u
      real(wp), intent(inout) :: u(:)          !! (n) by equation; comes back as it was [length]
      logical, intent(in) :: wanted(:)         !! (nread)
      logical, intent(in) :: reads(2)          !! von Mises' stress, that of flow; others are left 0
      type(slopes_type), allocatable, intent(out) :: slopes(:)   !! (nread)
      type(share_type) :: here
      integer :: listed(size(u)), i

      allocate (slopes(size(self%node)))
      do i = 1, size(self%unit)
         call read_unit(self, shape, self%unit(i), here)
         if (.not. any(wanted(here%place))) cycle
         if (has_slopes(shape, self%unit(i))) then
            call add_unit(self, shape, self%unit(i), pack(here%place, wanted(here%place)), reads, &
               & slopes)
         else
            call add_differences(self, shape, self%unit(i), here, u, wanted, reads, slopes)
         end if
      end do
      listed = 0
      do i = 1, size(slopes)
         call sum_by_dof(slopes(i), listed)
      end do
   end subroutine find_slopes

   !> Slopes at nodes of an element by the difference that each of its displacements makes.
   subroutine add_differences(self, shape, e, before, u, wanted, reads, slopes)
      type(surface_stress_type), intent(inout) :: self
      type(configuration_type), intent(in) :: shape
      integer, intent(in) :: e
      type(share_type), intent(in) :: before   !! what it says of its nodes where it stands
      real(wp), intent(inout) :: u(:)          !! (n) comes back as it was
      logical, intent(in) :: wanted(:), reads(2)
      type(slopes_type), intent(inout) :: slopes(:)
      integer, allocatable :: node(:)
      real(wp) :: way
      integer :: j, k

      allocate (node, source=unit_nodes(shape%solids, shape%mesh, e))
      way = step*maxval(maxval(shape%mesh%x(:, node), 2) - minval(shape%mesh%x(:, node), 2))
      do j = 1, size(node)
         do k = 1, shape%mesh%ndim
            if (shape%solids%dof(k, node(j)) > 0) call move(k, node(j), &
               & shape%solids%dof(k, node(j)))
         end do
      end do

   contains

      !> The difference that one displacement makes.
      subroutine move(component, at, dof)
         integer, intent(in) :: component, at, dof
         type(share_type) :: after
         real(wp) :: was(2), change(2)
         integer :: m

         was = [u(dof), self%u(component, at)]
         u(dof) = was(1) + way
         self%u(component, at) = was(1) + way
         call compute(self, shape, e)
         call read_unit(self, shape, e, after)
         do m = 1, size(before%place)
            associate (place => before%place(m))
               if (.not. wanted(place)) cycle
               change = 0.0_wp
               if (reads(1)) change(1) = dot_product(von_mises_slope(self%at_node(:, place)), &
                  & after%stress(:, m) - before%stress(:, m))/real(self%share(place), wp)
               if (self%weight(place) > 0.0_wp) change(2) = (after%flow(m) - before%flow(m)) &
                  & /self%weight(place)
               call add(slopes(place), dof, change/(u(dof) - was(1)))
            end associate
         end do
         u(dof) = was(1)
         self%u(component, at) = was(2)
      end subroutine move
   end subroutine add_differences

   pure logical function has_slopes(shape, e)
      type(configuration_type), intent(in) :: shape
      integer, intent(in) :: e

      associate (group => shape%solids%group(shape%solids%which(e)))
         if (shape%memory%finite_strain) then
            has_slopes = has_point_slopes(group%element)
         else
            has_slopes = has_flow_slopes(group%element, group%law)
         end if
      end associate
   end function has_slopes

   !> Slopes at nodes of an element or patch, by the tangents of its points.
   subroutine add_unit(self, shape, e, place, reads, slopes)
      type(surface_stress_type), intent(in) :: self
      type(configuration_type), intent(in) :: shape
      integer, intent(in) :: e
      integer, intent(in) :: place(:)          !! the nodes
      logical, intent(in) :: reads(2)
      type(slopes_type), intent(inout) :: slopes(:)   !! (nread)
      type(element_type) :: element
      type(element_input_type) :: input
      integer, allocatable :: node(:)
      real(wp), allocatable, target :: x(:, :), moved(:, :), past(:, :)
      real(wp), allocatable :: row(:, :, :), slope(:, :, :)
      logical, allocatable :: flowing(:)
      integer :: i, bad, of(2)

      of = [merge(1, 0, reads(1)), merge(count(reads), 0, reads(2))]   ! rows of a node
      allocate (node, source=unit_nodes(shape%solids, shape%mesh, e))
      associate (group => shape%solids%group(shape%solids%which(e)), p => shape%solids%patches)
         if (p%of(e) == 0) then
            element = group%element
         else
            call patch_element(p, p%of(e), shape%mesh%conn, group%element, element)
         end if
         x = shape%mesh%x(:, node)
         moved = self%u(:group%element%ndim, node)
         input%law => shape%solids%group(shape%solids%which(e))%law
         input%thickness = group%thickness
      end associate
      allocate (past, source=columns(shape%solids, shape%memory, e))
      input%x => x
      input%u => moved
      input%memory => past
      input%dt = shape%memory%dt
      input%scaled = shape%memory%scaled .and. input%law%remembers
      allocate (row(7, element%ngauss, count(reads)*size(place)), flowing(element%ngauss))
      call fill_rows(self, shape, e, place, of, row, flowing)
      if (all(abs(row) <= 0.0_wp)) return
      allocate (slope(element%ndim, element%nnode, size(row, 3)))
      if (shape%memory%finite_strain) then
         call finite_strain_slopes(element, input, flowing, row, slope, bad)
      else
         call flow_slopes(element, input, flowing, row, slope, bad)
      end if
      do i = 1, size(place)
         associate (first => (i - 1)*count(reads))
            call put(slopes(place(i)), shape%solids%dof(:element%ndim, node), &
               & slope(:, :, first + 1:first + count(reads)), of)
         end associate
      end do
   end subroutine add_unit

   !> Slopes of one node by the displacements of an element or patch.
   pure subroutine put(self, dof, slope, of)
      type(slopes_type), intent(inout) :: self
      integer, intent(in) :: dof(:, :)         !! (ndim, nnode) 0: held
      real(wp), intent(in) :: slope(:, :, :)   !! (ndim, nnode, rows)
      integer, intent(in) :: of(2)             !! see fill_rows
      real(wp) :: value(2)
      integer :: j, k

      do j = 1, size(dof, 2)
         do k = 1, size(dof, 1)
            if (dof(k, j) == 0) cycle
            value = 0.0_wp
            if (of(1) > 0) value(1) = slope(k, j, of(1))
            if (of(2) > 0) value(2) = slope(k, j, of(2))
            call add(self, dof(k, j), value)
         end do
      end do
   end subroutine put

   !> Factors of the stresses at the points in von Mises' stress and that of flow of some nodes.
   subroutine fill_rows(self, shape, e, place, of, row, flowing)
      type(surface_stress_type), intent(in) :: self
      type(configuration_type), intent(in) :: shape
      integer, intent(in) :: e, place(:)
      integer, intent(in) :: of(2)             !! rows of von Mises' stress, of flow; 0: none
      real(wp), intent(out) :: row(:, :, :)    !! (7, point, rows of a place by place)
      logical, intent(out) :: flowing(:)       !! points, since the accepted state
      integer, allocatable :: member(:)
      integer :: m, n

      row = 0.0_wp
      flowing = .false.
      allocate (member, source=members_of(shape%solids, e))
      n = size(flowing)/size(member)
      do m = 1, size(member)
         call fill_member(self, shape, member(m), place, of, row(:, (m - 1)*n + 1:m*n, :), &
            & flowing((m - 1)*n + 1:m*n))
      end do
   end subroutine fill_rows

   !> Those of the points of one element.
   subroutine fill_member(self, shape, e, place, of, row, flowing)
      type(surface_stress_type), intent(in) :: self
      type(configuration_type), intent(in) :: shape
      integer, intent(in) :: e, place(:), of(2)
      real(wp), intent(inout) :: row(:, :, :)
      logical, intent(inout) :: flowing(:)
      real(wp) :: mises(6), flow(size(flowing))
      integer :: a, i, k, first

      flow = 0.0_wp
      if (remembers(self, shape, e)) then
         associate (past => shape%memory%value(:, shape%memory%first(e):), &
            & next => self%next(:, shape%memory%first(e):), &
            & nstress => merge(4, 6, shape%mesh%ndim == 2), n => size(flow))
            where (next(stress_at(nstress), :n) > 0.0_wp) flow = 1.0_wp
            flowing = next(strain_at(nstress), :n) > past(strain_at(nstress), :n)
         end associate
      end if
      associate (element => shape%solids%group(shape%solids%which(e))%element)
         do a = 1, element%nnode
            i = findloc(place, self%place(shape%mesh%conn(a, e)), 1)
            if (i == 0) cycle
            first = (i - 1)*count(of > 0)
            if (of(1) > 0) then
               mises = von_mises_slope(self%at_node(:, place(i)))/real(self%share(place(i)), wp)
               do k = 1, size(flow)
                  row(:6, k, first + of(1)) = row(:6, k, first + of(1)) &
                     & + element%extrapolation(a, k)*mises
               end do
            end if
            if (of(2) > 0 .and. any(flow > 0.0_wp)) row(7, :, first + of(2)) = row(7, :, first &
               & + of(2)) + element%extrapolation(a, :)*flow/self%weight(place(i))
         end do
      end associate
   end subroutine fill_member

   !> Elements around a node share dofs: each is listed once.
   pure subroutine sum_by_dof(self, listed)
      type(slopes_type), intent(inout) :: self
      integer, intent(inout) :: listed(:)      !! (ndof) 0; comes back so
      integer :: j, k, n

      if (.not. allocated(self%dof)) allocate (self%dof(0), self%mises(0), self%flow(0))
      n = 0
      do j = 1, self%n
         k = listed(self%dof(j))
         if (k > 0) then
            self%mises(k) = self%mises(k) + self%mises(j)
            self%flow(k) = self%flow(k) + self%flow(j)
            cycle
         end if
         n = n + 1
         listed(self%dof(j)) = n
         self%dof(n) = self%dof(j)
         self%mises(n) = self%mises(j)
         self%flow(n) = self%flow(j)
      end do
      self%n = n
      listed(self%dof(:n)) = 0
   end subroutine sum_by_dof

   !> One slope more.
   pure subroutine add(self, dof, value)
      type(slopes_type), intent(inout) :: self
      integer, intent(in) :: dof
      real(wp), intent(in) :: value(2)

      if (.not. allocated(self%dof)) allocate (self%dof(64), self%mises(64), &
         & self%flow(64))
      if (self%n == size(self%dof)) then
         self%dof = [self%dof, self%dof]
         self%mises = [self%mises, self%mises]
         self%flow = [self%flow, self%flow]
      end if
      self%n = self%n + 1
      self%dof(self%n) = dof
      self%mises(self%n) = value(1)
      self%flow(self%n) = value(2)
   end subroutine add
end module lopin_surface_slopes
