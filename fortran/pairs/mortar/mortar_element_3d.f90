!> Mortar on the present shape in space: rows with exact slopes, forces and tangents.
!>
!> The rows and their slopes by all places come from lopin_mortar_rows_3d; the law is asked once in
!> dual numbers along gap, normal, slip and multiplier, and the chain rule does the rest.
module lopin_mortar_element_3d
   use lopin_kinds, only : wp
   use lopin_dual, only : dual_type, variable
   use lopin_surface, only : surface_type
   use lopin_dofs, only : dofs_type
   use lopin_mortar_overlap, only : overlap_list_type
   use lopin_mortar_cells_3d, only : mortar_kernel_type
   use lopin_mortar_cover, only : cover_type
   use lopin_mortar_rows_3d, only : mortar_row_type, new_mortar_rows, close_rows, &
      & find_lifts
   use lopin_mortar_traction_3d, only : slip_of_row, forces_of_row
   use lopin_contact_row, only : row_type, point_state_type, point_law_type, contact_status
   use lopin_row_element, only : press_row, set_spring
   use lopin_local_matrix, only : local_matrix_type
   implicit none
   private
   public :: space_mortar_type, update_space_mortar, evaluate_space_point

   !> A pair in space.
   type :: space_mortar_type
      type(mortar_kernel_type) :: kernel
      type(mortar_row_type), allocatable :: row(:)      !! (slave nodes) now
      type(mortar_row_type), allocatable :: before(:)   !! (slave nodes) when the increment began
      logical, allocatable :: lifts(:) !! (slave%nnode) no gap is less than the least that it weighs
      real(wp), allocatable :: lift(:) !! (slave%nnode) >= 0: what that adds [length]
   end type space_mortar_type

   !> Inputs of the law: gap, normal, slip, multiplier, growth of its bound.
   integer, parameter :: at_normal = 1, at_slip = 4, at_multiplier = 7, &
      & at_growth = 11

contains

   !> Rows at present places; at the start of an increment they are kept for the slip.
   subroutine update_space_mortar(self, cover, slave, master, x, list, start, with_slopes)
      type(space_mortar_type), intent(inout) :: self
      type(cover_type), intent(in) :: cover       !! by plan_rows
      type(surface_type), intent(in) :: slave, master
      real(wp), intent(in) :: x(:, :)             !! (3, nnode) [length]
      type(overlap_list_type), intent(in) :: list   !! found at x
      logical, intent(in) :: start                !! of an increment
      logical, intent(in) :: with_slopes          !! a tangent is wanted
      integer :: j

      if (start .or. .not. allocated(self%before)) then
         call new_mortar_rows(self%row, self%kernel, slave, master, x, list, with_slopes)
         call close_rows(self%row, x, cover)
         self%before = self%row
      else
         call new_mortar_rows(self%row, self%kernel, slave, master, x, list, with_slopes, &
            & self%before)
         call close_rows(self%row, x, cover)
         do j = 1, size(self%row)
            ! What is met only within the increment slips from where it was met first.
            if (self%before(j)%node == 0 .and. self%row(j)%node > 0) self%before(j) = self%row(j)
         end do
      end if
      if (start .or. with_slopes .or. .not. allocated(self%lift)) then
         if (.not. allocated(self%lift)) allocate (self%lift(slave%nnode))
         call find_lifts(self%lift, self%row, self%lifts, slave, master, x, list)
      end if
      self%row%gap = self%row%gap + self%lift
   end subroutine update_space_mortar

   !> Forces and exact tangent of one node, as evaluate_point of lopin_contact_element.
   subroutine evaluate_space_point(state, local, row, before, dofs, x, law)
      type(point_state_type), intent(inout) :: state
      type(local_matrix_type), intent(inout) :: local
      type(mortar_row_type), intent(in) :: row, before
      type(dofs_type), intent(in) :: dofs
      real(wp), intent(in) :: x(:, :)          !! (3, nnode) present places [length]
      type(point_law_type), intent(in) :: law
      real(wp) :: slip(3), slip_slope(3, 3*size(row%of))
      type(row_type) :: point
      integer :: k

      call slip_of_row(row, before, x, slip, slip_slope)
      point%shift = law%shift
      point%weight = row%weight
      point%gap = variable(row%gap, 1)
      point%normal = variable(row%normal, [(at_normal + k, k=1, 3)])
      point%slip = variable(slip, [(at_slip + k, k=1, 3)])
      point%multiplier = variable(law%lambda, [(merge(at_multiplier + k, 0, law%first_row > 0), &
         & k=1, 3)])
      if (law%follows) then
         call press_row(point, law, variable(law%at%growth, at_growth))
      else
         call press_row(point, law)
      end if
      state%status = point%status
      state%weight = row%weight
      state%row = point%residual%v
      state%gap = row%gap
      state%slip = slip
      state%normal = row%normal
      state%traction = point%z%v
      if (state%status == contact_status%open) then
         call stay_away()
      else
         call press()
      end if

   contains

      !> Open: no force on any dof; the multiplier's row is its own.
      subroutine stay_away()
         local%nu = 0
         state%force = [real(wp) ::]
         local%dof = [(dofs%n + law%first_row + k, k=0, merge(2, -1, law%first_row > 0))]
         if (.not. law%with_tangent) return
         call clear(local, size(local%dof))
         if (law%first_row > 0) call take_multiplier()
      end subroutine stay_away

      subroutine take_multiplier()
         integer :: i, j
         do j = 1, 3
            do i = 1, 3
               local%k(local%nu + i, local%nu + j) = point%residual(i)%d(at_multiplier + j)
            end do
         end do
      end subroutine take_multiplier

      subroutine press()
         integer :: way(3*size(row%of))        !! places of the local dofs
         real(wp) :: force(size(way)), along(3, size(way))
         real(wp) :: k_all(merge(size(way), 0, law%with_tangent), &
            & merge(size(way), 0, law%with_tangent))
         integer :: i, q

         call list_dofs(way)
         if (.not. law%with_tangent) then
            force = [(row%c(i)*point%z%v, i=1, size(row%of))]
            state%force = force(way(:local%nu))
            return
         end if
         call clear(local, size(local%dof))
         call chain(point%z, along)
         call forces_of_row(row, point%z%v, along, force, k_all)
         state%force = force(way(:local%nu))
         associate (nu => local%nu)
            local%k(:nu, :nu) = k_all(way(:nu), way(:nu))
            if (law%follows) local%by_bound = law%at%growth*[([(-row%c((way(i) + 2)/3) &
               & *point%z(modulo(way(i) - 1, 3) + 1)%d(at_growth), i=1, nu)]), &
               & ([(point%residual(q)%d(at_growth), q=1, merge(3, 0, law%first_row > 0))])]
            if (law%first_row > 0) call take_multiplier()
            call set_spring(local, law%enforcement, point, row%gap_slope(way(:nu)), &
               & slip_slope(:, way(:nu)))
            if (law%first_row == 0) return
            call chain(point%residual, along)
            local%k(nu + 1:, :nu) = along(:, way(:nu))
            do i = 1, nu
               do q = 1, 3
                  local%k(i, nu + q) = -row%c((way(i) + 2)/3) &
                     & *point%z(modulo(way(i) - 1, 3) + 1)%d(at_multiplier + q)
               end do
            end do
         end associate
      end subroutine press

      !> The free dofs of the row's nodes, then the multiplier's.
      subroutine list_dofs(way)
         integer, intent(out) :: way(:)
         integer :: free(3*size(row%of)), m, i

         local%nu = 0
         do i = 1, size(row%of)
            do m = 1, 3
               if (dofs%id(m, row%of(i)) == 0) cycle
               local%nu = local%nu + 1
               free(local%nu) = dofs%id(m, row%of(i))
               way(local%nu) = 3*(i - 1) + m
            end do
         end do
         local%dof = free(:local%nu)
         if (law%first_row > 0) local%dof = [local%dof, (dofs%n + law%first_row + m, m=0, 2)]
      end subroutine list_dofs

      !> Slopes by the places of what depends on gap, normal and slip.
      subroutine chain(y, along)
         type(dual_type), intent(in) :: y(3)
         real(wp), intent(out) :: along(:, :)  !! (3, 3n)
         integer :: i

         do i = 1, 3
            along(i, :) = y(i)%d(1)*row%gap_slope &
               & + matmul(y(i)%d(at_normal + 1:at_normal + 3), row%normal_slope) &
               & + matmul(y(i)%d(at_slip + 1:at_slip + 3), slip_slope)
         end do
      end subroutine chain
   end subroutine evaluate_space_point

   !> Room of a local matrix, zero.
   subroutine clear(local, n)
      type(local_matrix_type), intent(inout) :: local
      integer, intent(in) :: n

      if (allocated(local%k)) deallocate (local%k)
      if (allocated(local%spring)) deallocate (local%spring)
      if (allocated(local%reach)) deallocate (local%reach)
      if (allocated(local%glue)) deallocate (local%glue)
      if (allocated(local%flat_row)) deallocate (local%flat_row)
      allocate (local%k(n, n), local%spring(local%nu, local%nu), source=0.0_wp)
   end subroutine clear
end module lopin_mortar_element_3d
