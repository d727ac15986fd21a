!> Numbers of materials that do not fit together, whatever the system of units: a modulus in GPa
!> beside stresses in MPa shows in their ratio.
module lopin_check_materials
   use lopin_kinds, only : wp
   use lopin_error, only : severity, location_type
   use lopin_text, only : to_text
   use lopin_model, only : model_type, material_type
   use lopin_flow_curve, only : hardening_of, is_viscous
   implicit none
   private
   public :: check_materials

   !> Yield strains between which solids yield: lead has 3e-4, polymers some per cent, and a perfect
   !> crystal a tenth.
   real(wp), parameter :: least_yield = 5.0e-6_wp, most_yield = 0.1_wp
   !> Logarithmic plastic strain beyond which a table is meant in per cent: a stretch of 150.
   real(wp), parameter :: most_strain = 5.0_wp
   !> Thermal strain and pressure over modulus beyond which a solid is none.
   real(wp), parameter :: most_heat = 0.1_wp, most_pressure = 1.0_wp
   !> Stress by weight over modulus.
   real(wp), parameter :: most_weight = 1.0_wp
   character(len=*), parameter :: cure = 'write all numbers of the deck in one system of '// &
      & 'units: with N and mm, stresses and moduli are in MPa'

contains

   subroutine check_materials(model)
      type(model_type), intent(inout) :: model
      integer :: i

      call check_units(model)
      do i = 1, size(model%material)
         associate (material => model%material(i))
            if (.not. material%young > 0.0_wp) cycle
            if (material%poisson < 0.0_wp) call say(model, material%at, &
               & "Poisson's ratio of material `"// &
               & material%name//'` is '//to_text(material%poisson, 4)//': a body that grows '// &
               & 'wider when it is pulled', 'take the sign away if it is not meant')
            call check_yield(model, i)
            call check_heat(model, i)
         end associate
      end do
      call check_pressures(model)
   end subroutine check_materials

   !> Yield stress and flow curve beside Young's modulus: the first that does not fit.
   subroutine check_yield(model, i)
      type(model_type), intent(inout) :: model
      integer, intent(in) :: i
      character(len=:), allocatable :: name
      real(wp) :: share, most, slope

      associate (material => model%material(i))
         if (.not. (material%has_elastic .and. material%yield > 0.0_wp)) return
         name = ' of material `'//material%name//'`'
         share = material%yield/material%young
         most = largest_stress(material)
         slope = steepest(material)
         if (share > most_yield) then
            call say(model, material%plastic_at, 'the yield stress '// &
               & to_text(material%yield, 4)//name//' is '// &
               & to_text(share, 3)//' times its modulus '//to_text(material%young, 4)// &
               & ': MPa and GPa mixed?', cure)
         else if (share < least_yield .and. .not. is_viscous(material%flow)) then
            call say(model, material%plastic_at, 'the yield stress '// &
               & to_text(material%yield, 4)//name// &
               & ' is only '//to_text(share, 3)//' of its modulus '// &
               & to_text(material%young, 4)//': no solid yields at such a strain', cure)
         else if (most > material%young) then
            call say(model, material%plastic_at, &
               & 'the flow stress'//name//' grows to '//to_text(most, 4)// &
               & ', above its modulus '//to_text(material%young, 4), cure)
         else if (slope > material%young) then
            call say(model, material%plastic_at, &
               & 'the flow curve'//name//' rises by '//to_text(slope, 4)// &
               & ' per strain, more than the modulus '//to_text(material%young, 4)// &
               & ' of the elastic solid', 'stresses against plastic strains, not total ones; '// &
               & 'look at their units')
         else if (material%hardens .and. last_strain(material) > most_strain) then
            call say(model, material%plastic_at, &
               & 'the table'//name//' ends at a plastic strain of '// &
               & to_text(last_strain(material), 4)//': in per cent?', &
               & 'plastic strains are logarithmic and without unit: 20 % is 0.2')
         end if
      end associate
   end subroutine check_yield

   !> Of the whole curve; of a law without end, at a strain of 1.
   pure real(wp) function largest_stress(material) result(most)
      type(material_type), intent(in) :: material

      most = material%yield
      associate (flow => material%flow)
         if (flow%hardening == hardening_of%table) most = maxval(flow%stress)
         if (flow%hardening == hardening_of%swift) most = max(most, flow%constant(1))
         if (flow%hardening == hardening_of%voce) most = max(most, maxval(flow%constant(:2)) &
            & + flow%constant(4))
      end associate
   end function largest_stress

   !> The steepest rise by more than the yield stress: near yield curves may be steep.
   pure real(wp) function steepest(material) result(slope)
      type(material_type), intent(in) :: material
      real(wp) :: rise
      integer :: k

      slope = 0.0_wp
      associate (flow => material%flow)
         if (flow%hardening == hardening_of%voce) slope = flow%constant(4)
         if (flow%hardening /= hardening_of%table) return
         do k = 2, size(flow%strain)
            if (.not. flow%strain(k) > flow%strain(k - 1)) cycle
            rise = flow%stress(k) - flow%stress(k - 1)
            if (rise > material%yield) slope = max(slope, rise/(flow%strain(k) &
               & - flow%strain(k - 1)))
         end do
      end associate
   end function steepest

   pure real(wp) function last_strain(material) result(last)
      type(material_type), intent(in) :: material

      last = 0.0_wp
      if (material%flow%hardening == hardening_of%table) last = maxval(material%flow%strain)
   end function last_strain

   !> Thermal strains beyond any solid.
   subroutine check_heat(model, i)
      type(model_type), intent(inout) :: model
      integer, intent(in) :: i
      real(wp) :: most
      integer :: s, k

      associate (material => model%material(i))
         if (.not. material%has_expansion) return
         most = 0.0_wp
         do s = 1, size(model%step)
            do k = 1, size(model%step(s)%temperature)
               associate (t => model%step(s)%temperature(k))
                  most = max(most, abs(t%value - model%temperature(t%node)))
               end associate
            end do
         end do
         if (most*abs(material%expansion) > most_heat) call say(model, &
            & material%at, 'an expansion of '// &
            & to_text(material%expansion, 4)//' of material `'//material%name// &
            & '` and a change of temperature by '//to_text(most, 4)//' are a strain of '// &
            & to_text(100.0_wp*most*abs(material%expansion), 3)//' %', &
            & 'steel has 1.2e-5 per degree; *INITIAL CONDITIONS gives the temperature without '// &
            & 'strain')
      end associate
   end subroutine check_heat

   !> A pressure above the modulus of what it presses on; the first.
   subroutine check_pressures(model)
      type(model_type), intent(inout) :: model
      real(wp) :: most
      integer :: s, k, section

      do s = 1, size(model%step)
         do k = 1, size(model%step(s)%face_load)
            associate (load => model%step(s)%face_load(k))
               section = model%mesh%section(load%element)
               if (section == 0) cycle
               associate (material => model%material(model%section(section)%material))
                  most = max(abs(load%pressure), norm2(load%traction))
                  if (.not. most > most_pressure*material%young) cycle
                  if (.not. material%young > 0.0_wp) cycle
                  call say(model, load%at, 'a pressure of '//to_text(most, 4)// &
                     & ' acts on material `'//material%name//'`, whose modulus is '// &
                     & to_text(material%young, 4), cure)
                  return
               end associate
            end associate
         end do
      end do
   end subroutine check_pressures

   subroutine say(model, at, text, help)
      type(model_type), intent(inout) :: model
      type(location_type), intent(in) :: at
      character(len=*), intent(in) :: text, help
      call model%log%say(severity%warning, 'W0402', text, at, help=help)
   end subroutine say

   !> Weight that would crush what it acts on: rho g L beyond the modulus; the first. A modulus
   !> alone has no wrong unit: a bridge in Pa and m is as good as a bolt in MPa and mm.
   subroutine check_units(model)
      type(model_type), intent(inout) :: model
      real(wp) :: extent, weight
      integer :: s, k, section

      if (model%mesh%nnode == 0) return
      extent = maxval(maxval(model%mesh%x, dim=2) - minval(model%mesh%x, dim=2))
      do s = 1, size(model%step)
         do k = 1, size(model%step(s)%body_load)
            associate (load => model%step(s)%body_load(k))
               section = model%mesh%section(load%element)
               if (section == 0) cycle
               associate (material => model%material(model%section(section)%material))
                  weight = norm2(load%force)*extent
                  if (.not. weight > most_weight*material%young) cycle
                  if (.not. material%young > 0.0_wp) cycle
                  call model%log%say(severity%warning, 'W0401', 'a force of '// &
                     & to_text(norm2(load%force), 4)//' per volume over the '//to_text(extent, 4) &
                     & //' of the model makes a stress of '//to_text(weight, 4)// &
                     & ' in material `'//material%name//'`, whose modulus is '// &
                     & to_text(material%young, 4)//': density, gravity and modulus look as if '// &
                     & 'they were of different systems of units', load%at, &
                     & help='with t, mm, s and N, steel has density 7.8e-9 and E = 210000, and '// &
                     & 'gravity is 9810')
                  return
               end associate
            end associate
         end do
      end do
   end subroutine check_units
end module lopin_check_materials
