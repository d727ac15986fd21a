!> Work that heat does against the stresses: what it changes the elastic volume by, times the mean
!> stress there. Without it a body that is held and heated would seem to store energy from nowhere.
module lopin_heat_work
   use lopin_kinds, only : wp
   use lopin_model, only : model_type, is_heated
   use lopin_solids, only : solids_type
   use lopin_solid_small, only : strain_matrices
   use lopin_material_memory, only : offset_at, strain_at
   use lopin_recover_nonlinear, only : recover_nonlinear
   use lopin_scene, only : scene_type
   implicit none
   private
   public :: start_heat_work, add_heat_work

contains

   !> Work of the heat up to the trial state, by the trapezoidal rule over the increment, as that of
   !> the loads. Where a point begins to flow on the way, its stress may have been that of the end
   !> all along: how far the work is known is kept too.
   subroutine add_heat_work(scene, model)
      type(scene_type), intent(inout) :: scene
      type(model_type), intent(in) :: model
      real(wp), allocatable :: now(:)
      real(wp) :: change
      integer :: e, k, row

      if (.not. is_heated(model)) return
      associate (memory => scene%newton%past, next => scene%trial%solids, &
         & solids => scene%solids)
         call mean_stresses(scene, model, scene%trial%motion%u, now)
         next%heated = memory%heated
         next%place = memory%place
         next%heat = memory%heat
         next%unsure = memory%unsure
         do e = 1, model%mesh%nelement
            if (memory%first(e + 1) == memory%first(e)) cycle
            associate (n => solids%group(solids%which(e))%element%nstress)
               row = strain_at(n)
               do k = memory%first(e), memory%first(e + 1) - 1
                  next%heated(:, k) = [now(k), memory%value(offset_at(n), k)]
                  change = memory%place(k)*(next%heated(2, k) - memory%heated(2, k))
                  next%heat = next%heat + 0.5_wp*(memory%heated(1, k) + now(k))*change
                  if (next%value(row, k) > memory%value(row, k)) next%unsure = &
                     & next%unsure + 0.5_wp*abs((now(k) - memory%heated(1, k))*change)
               end do
            end associate
         end do
      end associate
   end subroutine add_heat_work

   !> Mean stress of all points that flow; Kirchhoff where strains are finite, as it works on the
   !> shape of the start.
   subroutine mean_stresses(scene, model, v, mean)
      type(scene_type), intent(in) :: scene
      type(model_type), intent(in) :: model
      real(wp), intent(in) :: v(:)             !! (ndof) displacements [length]
      real(wp), allocatable, intent(out) :: mean(:)      !! (ncolumn) [stress]
      real(wp), allocatable :: stress(:, :), strain(:, :)
      real(wp) :: u(3, model%mesh%nnode)
      integer :: e, i, k, node

      u = 0.0_wp
      do node = 1, model%mesh%nnode
         do i = 1, 3
            if (scene%dofs%id(i, node) > 0) u(i, node) = v(scene%dofs%id(i, node))
         end do
      end do
      associate (memory => scene%newton%past, first => scene%solids%first_point)
         call recover_nonlinear(scene%solids, model%mesh, u, memory, stress, strain)
         allocate (mean(size(memory%value, 2)))
         do e = 1, model%mesh%nelement
            do k = memory%first(e), memory%first(e + 1) - 1
               i = first(e) + k - memory%first(e)
               mean(k) = sum(stress(:3, i))/3.0_wp
               if (memory%finite_strain) mean(k) = mean(k)*exp(sum(strain(:3, i)))
            end do
         end do
      end associate
   end subroutine mean_stresses

   !> No work yet; the volumes of the points at the start.
   subroutine start_heat_work(scene, model)
      type(scene_type), intent(inout) :: scene
      type(model_type), intent(in) :: model
      integer :: e

      if (.not. is_heated(model)) return
      associate (memory => scene%accepted%solids)
         allocate (memory%heated(2, size(memory%value, 2)), source=0.0_wp)
         memory%heated(2, :) = memory%pressed
         allocate (memory%place(size(memory%value, 2)), source=0.0_wp)
         do e = 1, model%mesh%nelement
            if (memory%first(e + 1) > memory%first(e)) call measure(scene%solids, model, e, &
               & memory%place(memory%first(e):memory%first(e + 1) - 1))
         end do
      end associate
   end subroutine start_heat_work

   subroutine measure(solids, model, e, volume)
      type(solids_type), intent(in) :: solids
      type(model_type), intent(in) :: model
      integer, intent(in) :: e
      real(wp), intent(out) :: volume(:)       !! (ngauss) at the start [length^3]
      real(wp), allocatable :: b(:, :, :)
      real(wp) :: smallest
      integer :: point

      associate (group => solids%group(solids%which(e)))
         allocate (b(group%element%ndof, group%element%nstress, group%element%ngauss))
         call strain_matrices(group%element, model%mesh%x(:, model%mesh%conn( &
            & :group%element%nnode, e)), group%thickness, b, volume, smallest, point)
      end associate
   end subroutine measure
end module lopin_heat_work
