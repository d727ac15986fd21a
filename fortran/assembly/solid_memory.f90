!> The memory of all Gauss points that flow, and how the solids of a step are computed.
module lopin_solid_memory
   use lopin_kinds, only : wp
   use lopin_mesh, only : mesh_type
   use lopin_flow_curve, only : flow_stress
   use lopin_solids, only : solids_type
   use lopin_material_memory, only : rows_of, stress_at, temperature_at
   implicit none
   private
   public :: solid_memory_type, new_solid_memory, keep, at_all_points

   !> More Gauss points than an element has.
   integer, parameter :: most_points = 64

   type :: solid_memory_type
      logical :: in_use = .false.              !! some material looks back
      logical :: finite = .false.              !! finite strain; else small strain
      real(wp) :: dt = 1.0_wp                  !! time since the accepted state [time]
      real(wp) :: work = 0.0_wp                !! plastic work so far [force length]
      real(wp) :: next_work = 0.0_wp           !! that goes with `next` [force length]
      real(wp) :: most_strain = 0.0_wp         !! largest plastic strain between the two
      integer :: most_element = 0              !! where
      real(wp) :: volume = 0.0_wp              !! of the elements that flow, deformed [length^3]
      integer, allocatable :: first(:)         !! (nelement+1) first column of each element
      real(wp), allocatable :: value(:, :)     !! (nmemory, ncolumn) of module material_memory
      real(wp), allocatable :: next(:, :)      !! of the state just found, until it is kept
      real(wp), allocatable :: pressed(:)      !! (ncolumn) ln J of the stresses of the start [-]
      ! of solids that are heated; heat is its work [force length]
      real(wp) :: heat = 0.0_wp, next_heat = 0.0_wp
      real(wp) :: unsure = 0.0_wp, next_unsure = 0.0_wp  !! how far it is known [force length]
      real(wp), allocatable :: heated(:, :)    !! (2, ncolumn) mean stress and offset, accepted
      real(wp), allocatable :: next_heated(:, :)   !! the same of the state just found
      real(wp), allocatable :: place(:)        !! (ncolumn) volume of the start [length^3]
      real(wp), allocatable :: none(:, :)      !! (0, most_points): elements that remember nothing
   end type solid_memory_type

contains

   !> From rest: only elements whose law looks back have columns.
   subroutine new_solid_memory(self, solids, mesh)
      type(solid_memory_type), intent(out) :: self
      type(solids_type), intent(in) :: solids
      type(mesh_type), intent(in) :: mesh
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
      allocate (self%value(nrow, self%first(mesh%nelement + 1) - 1), source=0.0_wp)
      do e = 1, mesh%nelement
         if (self%first(e + 1) == self%first(e)) cycle
         associate (group => solids%group(solids%which(e)))
            call flow_stress(group%law%flow, 0.0_wp, 0.0_wp, &
               & self%value(stress_at(group%element%nstress), self%first(e)), slope, rate_slope)
            self%value(stress_at(group%element%nstress), self%first(e):self%first(e + 1) - 1) = &
               & self%value(stress_at(group%element%nstress), self%first(e))
            if (allocated(group%law%plastic)) self%value(temperature_at(group%element%nstress) + 1, &
               & self%first(e):self%first(e + 1) - 1) = &
               & self%value(stress_at(group%element%nstress), self%first(e))
         end associate
      end do
      allocate (self%next, source=self%value)
      allocate (self%pressed(size(self%value, 2)), source=0.0_wp)
   end subroutine new_solid_memory

   !> What was found by `remember` becomes the accepted state.
   pure subroutine keep(self)
      type(solid_memory_type), intent(inout) :: self
      if (.not. self%in_use) return
      self%value = self%next
      self%work = self%next_work
      self%heat = self%next_heat
      self%unsure = self%next_unsure
      if (allocated(self%next_heated)) self%heated = self%next_heated
   end subroutine keep

   !> One row of the newest memory at all Gauss points of the mesh; 0 where nothing flows.
   function at_all_points(self, solids, row) result(value)
      type(solid_memory_type), intent(in) :: self
      type(solids_type), intent(in) :: solids
      integer, intent(in) :: row
      real(wp), allocatable :: value(:)        !! (npoint)
      integer :: e, p, n

      allocate (value(solids%first_point(size(solids%first_point)) - 1), source=0.0_wp)
      if (.not. self%in_use) return
      do e = 1, size(self%first) - 1
         n = self%first(e + 1) - self%first(e)
         p = solids%first_point(e)
         if (n > 0) value(p:p + n - 1) = self%next(row, self%first(e):self%first(e + 1) - 1)
      end do
   end function at_all_points
end module lopin_solid_memory
