!> The memory of all Gauss points that flow: at rest, and read by point.
module lopin_solid_memory
   use lopin_kinds, only : wp
   use lopin_mesh, only : mesh_type
   use lopin_flow_curve, only : flow_stress
   use lopin_solids, only : solids_type
   use lopin_state, only : solids_state_type
   use lopin_material_memory, only : rows_of, stress_at, temperature_at
   implicit none
   private
   public :: new_solid_memory, at_all_points

   !> More Gauss points than an element has.
   integer, parameter :: most_points = 108

contains

   !> From rest: only elements whose law looks back have columns.
   subroutine new_solid_memory(self, solids, mesh, scaled)
      type(solids_state_type), intent(out) :: self
      type(solids_type), intent(in) :: solids
      type(mesh_type), intent(in) :: mesh
      logical, intent(in), optional :: scaled  !! a row more: see solids_state_type
      real(wp) :: slope, rate_slope
      integer :: e, nrow

      allocate (self%first(mesh%nelement + 1), self%none(0, most_points))
      self%first(1) = 1
      nrow = 0
      do e = 1, mesh%nelement
         self%first(e + 1) = self%first(e)
         if (solids%which(e) == 0) cycle
         associate (group => solids%group(solids%which(e)))
            if (.not. group%law%remembers) cycle
            self%first(e + 1) = self%first(e) + group%element%ngauss
            nrow = max(nrow, rows_of(group%law, group%element%nstress))
         end associate
      end do
      self%in_use = nrow > 0
      if (present(scaled)) self%scaled = scaled .and. nrow > 0
      if (self%scaled) nrow = nrow + 1
      allocate (self%value(nrow, self%first(mesh%nelement + 1) - 1), source=0.0_wp)
      do e = 1, mesh%nelement
         if (self%first(e + 1) == self%first(e)) cycle
         associate (group => solids%group(solids%which(e)))
            call flow_stress(group%law%flow, 0.0_wp, 0.0_wp, &
               & self%value(stress_at(group%element%nstress), self%first(e)), slope, rate_slope)
            self%value(stress_at(group%element%nstress), self%first(e):self%first(e + 1) - 1) = &
               & self%value(stress_at(group%element%nstress), self%first(e))
            if (allocated(group%law%plastic)) self%value(temperature_at(group%element%nstress) &
               & + 1, &
               & self%first(e):self%first(e + 1) - 1) = &
               & self%value(stress_at(group%element%nstress), self%first(e))
         end associate
      end do
      if (self%scaled) self%value(nrow, :) = 1.0_wp
      allocate (self%pressed(size(self%value, 2)), source=0.0_wp)
   end subroutine new_solid_memory

   !> One row of a memory at all Gauss points of the mesh; 0 where nothing flows.
   function at_all_points(self, solids, row) result(value)
      type(solids_state_type), intent(in) :: self
      type(solids_type), intent(in) :: solids
      integer, intent(in) :: row
      real(wp), allocatable :: value(:)        !! (npoint)
      integer :: e, p, n

      allocate (value(solids%first_point(size(solids%first_point)) - 1), source=0.0_wp)
      if (.not. self%in_use) return
      do e = 1, size(self%first) - 1
         n = self%first(e + 1) - self%first(e)
         p = solids%first_point(e)
         if (n > 0) value(p:p + n - 1) = self%value(row, self%first(e):self%first(e + 1) - 1)
      end do
   end function at_all_points
end module lopin_solid_memory
